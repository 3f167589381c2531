#pragma once

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// The fields of a scenario file with meaning, unit, range and default. A visitor that reads also checks the relations
/// between them, and throws InputError.
void describe(Fields& f, Scenario& scenario);

}  // namespace hapbench
