#pragma once

#include <string>
#include <vector>

#include "scenarios/description/scenario.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Warnings, each beginning with a JSON pointer, about hand and motion of `json`, from which `scenario` was read: one
/// for the first script of waypoints of each whose last leg begins only when the run is over. A shorter time step
/// with the same number of steps does that unnoticed.
std::vector<std::string> unplayed_script_warnings(const Json& json, const Scenario& scenario);

}  // namespace hapbench
