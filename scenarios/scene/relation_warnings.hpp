#pragma once

#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Warnings about values without effect in `json`, from which the scenario was read, such as the first script of
/// waypoints of hand and motion whose last leg begins only when the run is over: a shorter time step with the same
/// number of steps does that unnoticed.
std::vector<Warning> relation_warnings(const Scenario& scenario, const Json& json);

}  // namespace hapbench
