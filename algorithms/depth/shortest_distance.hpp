#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

/// What depth_models() shows of it.
extern const ModelInfo kShortestDistanceInfo;

std::unique_ptr<DepthModel> make_shortest_distance();

}  // namespace hapbench
