#pragma once

#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Kind of a warning: a value in the file is not used.
inline constexpr const char* kNoEffect = "no_effect";

/// Returns warnings about values in `json` that have no effect or are likely mistakes. `scenario` was read from `json`.
/// Examples: a parameter that the algorithm does not use; a handle of 80 kg; a script of waypoints whose last segment
/// begins after the end of the run. The run becomes too short for a script, for example, if the time step is reduced
/// and the number of steps is not increased.
std::vector<Warning> relation_warnings(const Scenario& scenario, const Json& json);

}  // namespace hapbench
