#pragma once

#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

CodecPtr<IntegratorFields> integrator_codec();

}  // namespace hapbench
