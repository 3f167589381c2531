#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kOriginalAveragingInfo;

std::unique_ptr<ForceLaw> make_original_averaging(const RenderingConfig& config);

}  // namespace hapbench
