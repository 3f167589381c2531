#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

extern const ModelInfo kNormalProjectionDepthInfo;

std::unique_ptr<DepthModel> make_normal_projection_depth();

}  // namespace hapbench
