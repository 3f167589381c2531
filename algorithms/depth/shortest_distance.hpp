#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

/// What depth_models() shows of it.
extern const ModelInfo kShortestDistanceInfo;

std::unique_ptr<DepthModel> make_shortest_distance();

/// The depths of `shortest_distance` alone, gradients untouched: shared with `surface_normal`. O(n).
void shortest_distance_depths(const Tool& tool, const ToolPose& pose, ContactBuffer& contacts) noexcept;

}  // namespace hapbench
