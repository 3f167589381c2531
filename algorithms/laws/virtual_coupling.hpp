#pragma once

#include "algorithms/laws/force_law.hpp"

namespace hapbench {

extern const ModelInfo kVirtualCouplingInfo;

std::unique_ptr<ForceLaw> make_virtual_coupling(const RenderingConfig& config);

}  // namespace hapbench
