#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kNormalProjectionInfo;

std::unique_ptr<ForceLaw> make_normal_projection(const RenderingConfig& config);

}  // namespace hapbench
