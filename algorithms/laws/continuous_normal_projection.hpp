#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kContinuousNormalProjectionInfo;

std::unique_ptr<ForceLaw> make_continuous_normal_projection(const RenderingConfig& config);

}  // namespace hapbench
