#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kTandpastaInfo;

std::unique_ptr<ForceLaw> make_tandpasta(const RenderingConfig& config);

}  // namespace hapbench
