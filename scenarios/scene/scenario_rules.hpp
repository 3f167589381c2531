#pragma once

#include "scenarios/scene/scenario.hpp"

/// Rules between the fields of a scenario. A schema cannot express them.
namespace hapbench {

/// Throws InputError if fields contradict each other or a size limit is exceeded. `steps` is the requested number
/// of time steps. Its type is double, because the number may exceed the range of integers.
void check_relations(const Scenario& scenario, double steps);

}  // namespace hapbench
