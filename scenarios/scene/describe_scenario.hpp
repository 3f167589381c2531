#pragma once

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Describes the fields of a scenario file with meaning, unit, range and default. When a file is read, also
/// checks the rules between fields (check_relations). Throws InputError if a rule is broken.
void describe(Fields& f, Scenario& scenario);

}  // namespace hapbench
