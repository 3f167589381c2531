#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/input/fields.hpp"

namespace hapbench {

/// Is told a file that a value names: the JSON pointer of the field, the path as the field has it, and the content.
using OnFile = std::function<void(const std::string& pointer, const std::string& path, const FileContent& content)>;

/// The JSON of what `value` describes. Tells the files it names in order. Throws std::logic_error for one without a
/// name.
Json json_of(Fields::Body value, const OnFile& file = nullptr);

/// The JSON of a value, by its `describe`, which says of what kind it is.
template <class T>
Json written(T value) {
  return json_of([&value](Fields& f) { describe(f, value); });
}

/// The JSON of a struct, by its `describe`.
template <class T>
Json written_object(T value) {
  return json_of([&value](Fields& f) { f.object(value); });
}

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
