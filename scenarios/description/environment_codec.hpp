#pragma once

#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The environment object of a scenario, chosen by "type".
CodecPtr<Environment> environment_codec();

/// Names of the environment types.
std::vector<std::string> environment_names();

}  // namespace hapbench
