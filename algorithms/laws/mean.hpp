#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kMeanInfo;

std::unique_ptr<ForceLaw> make_mean(const RenderingConfig& config);

}  // namespace hapbench
