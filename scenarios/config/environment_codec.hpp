#pragma once

#include "scenarios/codec/codec.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

/// The environment object of a scenario, chosen by "type".
CodecPtr<Environment> environment_codec();

/// Names of the environment types.
std::vector<std::string> environment_names();

}  // namespace hapbench
