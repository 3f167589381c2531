#pragma once

#include <span>

#include "algorithms/info.hpp"
#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

CodecPtr<IntegratorFields> integrator_codec();

/// What `hapbench list` and `describe` tell of each integrator, in the order of kIntegrators.
std::span<const ModelInfo> integrator_infos();

}  // namespace hapbench
