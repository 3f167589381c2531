#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Is told a file that a value names: the JSON pointer of the field, the path as the field has it, and the content.
using OnFile = std::function<void(const std::string& pointer, const std::string& path, const FileContent& content)>;

/// The JSON of what `value` describes. Tells the files it names in order. Throws std::logic_error for one without a
/// name.
Json json_of(Fields::Body value, const OnFile& file = nullptr);

/// The JSON of a field's default: as json_of, without the fields inside it whose default depends on the scenario.
Json default_of(Fields::Body value);

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

}  // namespace hapbench
