#pragma once

#include <string>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Reads and checks a JSON value, found at the JSON pointer `at`, into what `value` describes. Fields that the file
/// does not have leave their members as they are. Throws InputError, of kind shape for what the schema refuses too,
/// that names the place, the value and what is allowed. After a fault the remaining fields and entries are still read,
/// so that one error reports the faults of all.
void read_value(const Json& json, const std::string& at, Fields::Body value);

}  // namespace hapbench
