#pragma once

#include "scenarios/description/object.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The description of a scenario file: every field with its meaning, unit, range and default.
const ObjectCodec<Scenario>& scenario_codec();

/// The whole JSON Schema (draft 7) that scenarios/scenario.schema.json holds.
Json scenario_schema();

}  // namespace hapbench
