#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// Reads a scenario file and the files that it extends, without checking their fields.
namespace hapbench {

/// Name of the field that names a base scenario. The fields of the file with this field are merged over the fields of
/// the base scenario.
inline constexpr const char* kExtends = "extends";

/// A scenario file and its content before merging with the scenario that it extends.
struct ScenarioLayer {
  std::filesystem::path file;
  Json json;
};

/// A scenario file after merging with the scenarios that it extends. It can be loaded several times with
/// different overrides without reading the files again.
struct ScenarioText {
  std::filesystem::path file;
  Json json;
  /// The file itself, then the file that it extends, then the file that this file extends, and so on. Empty if the
  /// first file extends no other file.
  std::vector<ScenarioLayer> layers = {};
};

/// Reads a scenario file and, recursively, the scenario that its field "extends" names. The field holds a file
/// path, relative to the file that has the field, or the name of a bundled scenario. Rules of the merge:
///   - Objects are merged field by field. An object with another "type" replaces the base's object.
///   - Every other value, including null, replaces the base's value.
///   - If two fields exclude each other ("steps" and "duration_s"), the given field removes the
///     base's other field.
///   - "name" and "expect" are not inherited.
///   - A relative path in a field "file" stays relative to the file that it was read from.
/// Throws InputError whose message begins with the faulty file. A file that extends itself, directly or through
/// other files, is an error.
ScenarioText read_scenario_text(const std::filesystem::path& file);

/// Throws InputError if the scenario `json` was read from a file without a folder (has_no_folder), such as a pipe, and
/// names a file by a relative path.
void require_absolute_paths(const std::filesystem::path& file, const Json& json);

}  // namespace hapbench
