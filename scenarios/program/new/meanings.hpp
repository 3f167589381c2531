#pragma once

#include <nlohmann/json.hpp>

#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Returns an object with the meaning of each field in a scenario, by the field's dotted path. Objects come
/// before their fields.
Json field_meanings(const Json& scenario);

}  // namespace hapbench
