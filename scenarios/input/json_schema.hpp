#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"

/// Explains which values a description of fields allows, as a JSON Schema and in words.
namespace hapbench {

struct FieldGuide;

/// The values that are allowed: as a JSON Schema (draft 7), in words, and by the fields of an object.
struct ValueGuide {
  Json schema;
  std::string allowed;              ///< as in "a number > 0 and <= 10 [m]"
  std::vector<FieldGuide> fields;   ///< of an object whose fields no type chooses, or that is of one type
  std::vector<ValueGuide> choices;  ///< the objects among which a field "type" chooses
  std::string type, summary;        ///< of such an object: its type, and what that is in a few words
  bool may_be_untyped = false;      ///< of such an object: it may stand without its type
};

/// A field of an object.
struct FieldGuide {
  std::string name;
  std::string meaning;
  Presence presence;
  Json initial;  ///< the default, with Presence::has_default
  ValueGuide value;

  /// The schema of the value with meaning and default.
  Json schema() const;
};

/// Which values are allowed where `value` describes them. Defaults are those of the described object, which has to be a
/// default-constructed one. With `definitions`, values that are described alike in many places are put there once, by
/// their names, and the schema refers to "#/definitions/NAME". Throws std::logic_error where two pairs of fields of one
/// object exclude each other, for which the schema has no place.
ValueGuide guide_to(Fields::Body value, Json* definitions = nullptr);

}  // namespace hapbench
