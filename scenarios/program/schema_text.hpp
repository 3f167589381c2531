#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// The JSON Schema as words for the terminal.
namespace hapbench {

/// The schema of a scenario in full, built once.
const Json& scenario_schema_once();

/// The part of the schema that `name` means: "scenario" for all of it, a dotted field path ("rendering.limits"), or the
/// "type" of a tagged object ("hole_2d"). Null when there is none.
const Json* find_in_schema(const Json& schema, const std::string& name);

/// The values a schema allows, in a few words: "number > 0 <= 1000", "null | integer >= 0 <= 5".
std::string allowed_text(const Json& schema);

/// The default of a field; "by scene" for one whose default depends on other fields.
std::string default_text(const Json& schema);

/// The fields of an object schema as a table of name, default, allowed values and meaning; one line for a plain value.
std::string fields_text(const std::string& title, const Json& schema);

/// A field of a scenario and what the schema says of it.
struct FieldMeaning {
  std::string path;  ///< dotted
  std::string meaning;
};

/// The meaning of each field that a scenario's JSON has, objects before their fields.
std::vector<FieldMeaning> field_meanings(const Json& scenario);

}  // namespace hapbench
