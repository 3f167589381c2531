#pragma once

#include <memory>

#include "sim/core/model_info.hpp"
#include "algorithms/rendering_config.hpp"
#include "algorithms/stages/point_stage.hpp"

namespace hapbench {

extern const ModelInfo kGradientReductionInfo;

std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config);

}  // namespace hapbench
