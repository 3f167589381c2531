#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// Callback for each file that a value names. Receives the JSON pointer of the field, the path in the field, and
/// the kind of content.
using OnFile = std::function<void(const std::string& pointer, const std::string& path, const FileContent& content)>;

/// Returns the JSON of the value that `value` describes. If the callback `file` is given, calls it for each file that
/// the value names, in the order of the fields. Throws std::logic_error if an enumerator has no name or a variant has
/// no value.
Json json_of(Fields::Body value, const OnFile& file = nullptr);

/// Returns the JSON of a field's default value. In contrast to json_of, omits inner fields whose default depends
/// on the scenario (Presence::no_default).
Json default_of(Fields::Body value);

/// Returns the JSON of a value for whose type a function describe(Fields&, T&) exists.
template <class T>
Json written(T value) {
  return json_of([&value](Fields& f) { describe(f, value); });
}

/// Returns the JSON object of a struct whose fields a function describe(Fields&, T&) describes.
template <class T>
Json written_object(T value) {
  return json_of([&value](Fields& f) { f.object(value); });
}

}  // namespace hapbench
