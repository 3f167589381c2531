#pragma once

#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// The JSON Schema as words for the terminal.
namespace hapbench {

/// The schema of a scenario in full, built once, and again when an algorithm has been added.
const Json& scenario_schema_once();

/// The part of the schema that `name` means: "scenario" for all of it, or a dotted field path ("rendering.limits").
/// Null when there is none.
const Json* find_in_schema(const Json& schema, const std::string& name);

/// A field as some of the types have it among which an object around it chooses.
struct TypedField {
  std::string types;  ///< `hand.type "drag"`; empty where all have it
  const Json* schema = nullptr;
};
/// The fields at a dotted path, those that are the same for several types once; none when there is no such path.
std::vector<TypedField> typed_fields(const Json& schema, const std::string& path);

/// The tagged objects of that "type" ("mesh"), those that are the same in several fields once; `types` is the field
/// ("tool").
std::vector<TypedField> types_called(const Json& schema, const std::string& type);

/// The values a schema allows, in a few words: "number > 0 <= 1000", "null | integer >= 0 <= 5".
std::string allowed_text(const Json& schema);

/// The default of a field; "by scene" for one whose default depends on other fields.
std::string default_text(const Json& schema);

/// What there is to say of a field; empty where there is nothing.
struct FieldCard {
  std::string name;
  std::string unit;
  std::string initial;  ///< its default
  std::string allowed;
  std::string meaning;
};

/// The card of a field: its name, and below it the facts and the meaning, as wide as prose is.
std::string card(const FieldCard& field, std::size_t indent = 2);

/// What a tagged object of that "type" is, in a few words; null for names that are no type of environment, hand, device
/// or profile. `field` is what it is a type of, as "hand", since two fields may have types of one name.
const char* type_summary(std::string_view type, std::string_view field);

/// The types among which the object of a field chooses, as those of "environment".
std::vector<std::string> type_names(const std::string& field);

/// The fields of an object schema as cards; of a choice among tagged objects those of each; a few lines for a plain
/// value. `types` as of a TypedField.
std::string fields_text(const std::string& title, const Json& schema, const std::string& types = "");

/// What `type_field`, as "hand.type", may say, and what each means; empty for a field that chooses no type.
std::string types_text(const std::string& type_field);

/// A field of a scenario and what the schema says of it.
struct FieldMeaning {
  std::string path;  ///< dotted
  std::string meaning;
};

/// The meaning of each field that a scenario's JSON has, objects before their fields.
std::vector<FieldMeaning> field_meanings(const Json& scenario);

}  // namespace hapbench
