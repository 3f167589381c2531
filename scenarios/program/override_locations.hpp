#pragma once

#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

/// Returns a copy of the error. For each fault in a field that --set gave, the copy names --set with the value as typed
/// instead of the scene's file. `overrides` are the values of --set.
InputError with_override_locations(const InputError& error, const std::vector<std::string>& overrides);

}  // namespace hapbench
