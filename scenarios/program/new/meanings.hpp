#pragma once

#include <nlohmann/json.hpp>

#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Returns a JSON object with the meaning of each field in a scenario. The keys are the dotted paths of the fields.
/// Objects come before their fields.
Json field_meanings(const Json& scenario);

}  // namespace hapbench
