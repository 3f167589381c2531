#pragma once

#include <string>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Reads a JSON value into the C++ object that `value` describes, and checks it. `at` is the JSON pointer of the value,
/// for messages. If the JSON lacks an optional field, the member of this field stays unchanged. A missing required
/// field is a fault. Throws InputError with the location, the given value and the allowed values. The error has kind
/// `shape` if the JSON Schema rejects the value too. Reading continues after a fault, so that one error reports the
/// faults of all fields and entries, up to kMaxFaults faults.
void read_value(const Json& json, const std::string& at, Fields::Body value);

}  // namespace hapbench
