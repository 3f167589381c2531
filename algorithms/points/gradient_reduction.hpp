#pragma once

#include <memory>

#include "algorithms/info.hpp"
#include "algorithms/points/point_stage.hpp"
#include "algorithms/rendering_config.hpp"

namespace hapbench {

extern const ModelInfo kGradientReductionInfo;

std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config);

}  // namespace hapbench
