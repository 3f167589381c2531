#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kSummationInfo;

std::unique_ptr<ForceLaw> make_summation(const RenderingConfig& config);

}  // namespace hapbench
