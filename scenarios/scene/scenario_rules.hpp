#pragma once

#include "scenarios/scene/scenario.hpp"

/// Rules between the fields of a scenario, which a schema cannot express.
namespace hapbench {

/// Throws InputError for fields that contradict each other. `steps` may be more than a scenario can hold.
void check_relations(const Scenario& scenario, double steps);

}  // namespace hapbench
