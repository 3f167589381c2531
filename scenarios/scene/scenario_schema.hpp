#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_schema.hpp"

namespace hapbench {

/// The whole JSON Schema (draft 7) that scenarios/library/scenario.schema.json holds.
Json scenario_schema();

/// The guide to a scenario in full, that is, with the fields of the scenario that it extends filled in. It is built
/// once, and again after an algorithm has been added; references stay valid. For several threads.
const ValueGuide& scenario_guide();

/// A field of scenarios; those of list entries aside.
struct PlacedField {
  std::string path;   ///< dotted, as "rendering.limits.max_force_N"
  std::string types;  ///< that lead to it, as `hand.type "drag"`; empty where all types have it
  const FieldGuide* field = nullptr;
};
/// All of them, once for each type that has them.
std::vector<PlacedField> placed_fields();

/// Their paths, each once, and those of the fields "type".
std::vector<std::string> scenario_field_paths();

}  // namespace hapbench
