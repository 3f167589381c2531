#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Field that names a base scenario. The fields of the file that has it are merged over the base scenario's
/// fields.
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
  /// The file, then the scenario that it extends, then that scenario's base, and so on; empty if it extends
  /// nothing.
  std::vector<ScenarioLayer> layers = {};
};

/// A scenario whose fields are checked. Its files are not read yet (CheckedScenario in
/// scenarios/run/checked_scenario.hpp).
struct LoadedScenario {
  Scenario scenario;
  std::filesystem::path file;
  NamedFiles files;                    ///< files that the scenario names
  std::vector<Warning> warnings;       ///< about values in the file that have no effect, or are likely mistakes
  /// As in ScenarioText, with the overrides applied to the first layer; empty if the file extends nothing.
  std::vector<ScenarioLayer> layers;
};

/// Reads a scenario file and, recursively, the scenario that its field "extends" names. The field holds a file
/// path, relative to the file that has the field, or the name of a bundled scenario. Rules of the merge:
///   - Objects are merged field by field. An object with another "type" replaces the base's object.
///   - Every other value replaces the base's value; null does too.
///   - If two fields exclude each other ("steps" and "duration_s"), the given field removes the
///     base's other field.
///   - "name" and "expect" are not inherited.
///   - A relative path in a field "file" stays relative to the file that it was read from.
/// Throws InputError whose message begins with the faulty file. A file that extends itself, directly or through
/// other files, is an error.
ScenarioText read_scenario_text(const std::filesystem::path& file);

/// Applies the overrides to a scenario that was read before, and checks the result. The overload below describes
/// the rules and errors. Several threads may pass the same `text`.
LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides);

/// Reads a scenario file and the scenarios that it extends, applies the overrides and checks the result. An
/// override is `path=value`: a dotted path, and a value that is parsed as JSON, or taken as text if it is not
/// JSON. Later overrides win.
/// The field "expect" describes the run without overrides. If an override changes the run, the bounds on metrics
/// are dropped, and the default outcomes are allowed in addition to the listed outcomes.
/// Throws InputError whose message begins with the faulty file.
inline LoadedScenario load_scenario(const std::filesystem::path& file, std::span<const std::string> overrides = {}) {
  return load_scenario(read_scenario_text(file), overrides);
}
/// Checks a scenario given as JSON, which must not extend another scenario. Relative paths start from
/// `directory`. Throws InputError without a file.
LoadedScenario read_scenario(const Json& json, const std::filesystem::path& directory);

/// Returns the dotted path of an override `path=value`.
inline std::string_view overridden_path(std::string_view override) noexcept {
  return override.substr(0, override.find('='));
}

/// Returns the file that sets the value at a JSON pointer: the scenario's file, or a file that it extends. If no
/// file sets the value, returns the file that has the nearest enclosing object.
std::filesystem::path file_of(const LoadedScenario& loaded, const std::string& pointer);

/// Returns the warnings as texts for people. Each text begins with the file that sets the value, and its pointer.
std::vector<std::string> with_files(const LoadedScenario& loaded, const std::vector<Warning>& warnings);

/// Throws a copy of the error that names `file` in front of each fault.
[[noreturn]] void rethrow_with_file(const InputError& error, const std::filesystem::path& file);
/// Throws a copy of the error that names, in front of each fault, the file that has the fault: the scenario's
/// file, or a file that it extends.
[[noreturn]] void rethrow_with_file(const InputError& error, const LoadedScenario& loaded);

/// Calls `work` and returns its result. An InputError that `work` throws is passed to rethrow_with_file with
/// `place`, which is a file or a loaded scenario.
template <class Place, class Work>
auto with_file(const Place& place, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    rethrow_with_file(error, place);
  }
}

/// Returns the scenario as JSON with every default filled in. Reading this JSON gives the same run. File paths in
/// it are relative to `directory`.
Json effective_scenario(const Scenario& scenario, const std::filesystem::path& directory);

/// Returns a hash that identifies the simulated input: FNV-1a, as 16 hexadecimal digits, over the effective
/// scenario in which the path of each file is replaced by the hash of the file's contents. `files` are the
/// scenario's files. Throws InputError if a file cannot be read.
std::string scenario_hash(Json effective, const NamedFiles& files);

}  // namespace hapbench
