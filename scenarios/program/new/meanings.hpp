#pragma once

#include <nlohmann/json.hpp>

#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// The meaning of each field that a scenario has, by its path; objects come before their fields.
Json field_meanings(const Json& scenario);

}  // namespace hapbench
