#pragma once

#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

/// The error with what was typed as the place of each fault in a field that --set gave, and not the scene's file.
InputError with_typed_places(const InputError& error, const std::vector<std::string>& overrides);

}  // namespace hapbench
