#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/scenario.hpp"

/// Access to the value of a scenario's field by its path.
namespace hapbench {

/// Returns the scenario's current value at a path, dotted as in --set; null if the path names no field.
Json current_value(const Scenario& scenario, const std::string& path);

}  // namespace hapbench
