#pragma once

#include "scenarios/codec/object.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

/// The description of a scenario file: every field with its meaning, unit, range and default.
const ObjectCodec<Scenario>& scenario_codec();

/// The whole JSON Schema (draft 7) that scenarios/scenario.schema.json holds.
Json scenario_schema();

/// Most shell points or springs an environment may have, and most rows a run may record: beyond them memory or disk
/// would be absurd for a bench.
inline constexpr double kMostPoints = 2e7;
inline constexpr double kMostSteps = 1e9;
inline constexpr double kMostRows = 2e7;

}  // namespace hapbench
