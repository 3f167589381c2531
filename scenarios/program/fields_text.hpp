#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scenarios/format/writer.hpp"

/// The fields of scenario files as text for the terminal. Names of fields are dotted paths, as "rendering.limits".
namespace hapbench {

/// The field at that path, of the first type that has it where types choose the fields; null when there is none.
const FieldGuide* find_field(const std::string& path);

/// A field as some of the types have it among which an object around it chooses.
struct TypedField {
  std::string types;  ///< as `hand.type "drag"`; empty where all types have it
  const FieldGuide* field = nullptr;
};
/// The fields at that path, those that are the same for several types once.
std::vector<TypedField> typed_fields(const std::string& path);

/// The names of the types among which a field chooses, as those of "environment"; none for other fields.
std::vector<std::string> type_names(const std::string& field);

/// A type among which a field chooses.
struct FieldType {
  std::string field;
  const ValueGuide* type;
};
/// All of them, those that are the same in several fields once.
std::vector<FieldType> all_types();

/// The default of a field; "by scene" for one whose default depends on other fields.
std::string default_text(const FieldGuide& field);

/// The text about a field; parts may be empty.
struct FieldCard {
  std::string name;
  std::string initial = "";  ///< its default
  std::string allowed = "";
  std::string meaning = "";
};

/// The card of a field: its name, and below it the facts and the meaning, as wide as prose is.
std::string card(const FieldCard& field, std::size_t indent = 2);

/// The fields of an object as cards; of a choice among objects those of each; a few lines for a plain value. `of` names
/// the types or the field that have the value, where others have another of that title.
std::string fields_text(const std::string& title, const ValueGuide& value, const std::string& of = "");
std::string fields_text(const std::string& title, const FieldGuide& field, const std::string& of = "");

/// The values of `type_field`, as "hand.type", with their meanings; empty for a field that chooses no type.
std::string types_text(const std::string& type_field);

/// The path and the meaning of each field that a scenario's JSON has, objects before their fields.
std::vector<std::pair<std::string, std::string>> field_meanings(const Json& scenario);

}  // namespace hapbench
