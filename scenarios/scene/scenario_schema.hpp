#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_schema.hpp"

namespace hapbench {

/// Returns the JSON Schema (draft 7) of scenario files, which is stored in
/// scenarios/library/scenario.schema.json.
Json scenario_schema();

/// Returns the documentation of a complete scenario, that is, after merging with the scenario that it extends. It
/// is built on the first call, and again after an algorithm has been added. Earlier references stay valid.
/// Thread-safe.
const ValueGuide& scenario_guide();

/// A field of a scenario, with its path. Fields of list entries are not included.
struct ScenarioField {
  std::string path;   ///< dotted path, such as "rendering.limits.max_force_N"
  std::string types;  ///< condition on types, such as `hand.type "drag"`; empty if all types have the field
  const FieldGuide* field = nullptr;
};
/// Returns all fields of scenarios. A field that several types have is listed once for each type.
std::vector<ScenarioField> scenario_fields();

/// Returns the paths of all fields, including the fields "type". Each path is listed once.
std::vector<std::string> scenario_field_paths();

}  // namespace hapbench
