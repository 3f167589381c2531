#pragma once

#include <span>

#include "algorithms/info.hpp"

namespace hapbench {

/// What `hapbench list` and `describe` tell of each integrator, in the order of kIntegrators.
std::span<const ModelInfo> integrator_infos();

}  // namespace hapbench
