#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

extern const ModelInfo kNormalProjectionDepthInfo;

std::unique_ptr<DepthModel> make_normal_projection_depth();

/// How far [m] `point` in the tool lies from where the ray along the unit vector u leaves it: the depth of
/// `normal_projection`, shared with `continuous_normal_projection`.
double exit_distance(const Tool& tool, const ToolPose& pose, const Vec3& point, const Vec3& u) noexcept;

}  // namespace hapbench
