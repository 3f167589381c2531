#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"

/// Documentation of the values that a description of fields allows: a JSON Schema and plain text.
namespace hapbench {

struct FieldGuide;

/// Documentation of one value: a JSON Schema (draft 7), a text, and the fields if the value is an object.
struct ValueGuide {
  Json schema;
  std::string allowed;             ///< allowed values as a text, such as "a number > 0 and <= 10 [m]"
  std::vector<FieldGuide> fields;  ///< fields of an object without alternatives, or of one alternative
  /// Alternatives of an object whose field "type" selects one of them; empty for other values.
  std::vector<ValueGuide> choices;
  std::string type, summary;    ///< only for an alternative: its value of the field "type", and a short description
  bool may_be_untyped = false;  ///< only for an alternative: true if the field "type" may be omitted
};

/// Documentation of a field of an object.
struct FieldGuide {
  std::string name;
  std::string meaning;
  Presence presence;
  Json initial;  ///< the default value if presence is Presence::has_default; otherwise null
  ValueGuide value;

  /// Returns the schema of the value, extended by the field's meaning and default.
  Json schema() const;
};

/// Returns the documentation of the values that `value` describes. Defaults are read from the described C++
/// object. Precondition: that object is default-constructed. If `definitions` is not null, each value that is
/// described by Fields::shared is stored there once, by its name, and the schema refers to "#/definitions/NAME".
/// Throws std::logic_error if one object calls exactly_one_of twice, which the schema cannot express.
ValueGuide guide_to(Fields::Body value, Json* definitions = nullptr);

}  // namespace hapbench
