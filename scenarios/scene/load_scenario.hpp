#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/scenario_text.hpp"

namespace hapbench {

/// A scenario whose fields have been checked. The files that the scenario names have not been read;
/// scenarios/run/checked_scenario.hpp reads and checks them.
struct LoadedScenario {
  Scenario scenario;
  std::filesystem::path file;
  NamedFiles files;               ///< files that the scenario names
  std::vector<Warning> warnings;  ///< warnings about values in the file that have no effect, or are likely mistakes
  /// The scenario's file and the files that it extends (ScenarioText::layers), with the overrides applied to the first
  /// of these files. Empty if the scenario's file extends no other file.
  std::vector<ScenarioLayer> layers;
  std::vector<std::string> overrides;  ///< overrides that were applied to the scenario's file
};

/// Applies the overrides to a scenario that was read before, and checks the result. The overload below describes
/// the rules and errors. Several threads may pass the same `text`.
LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides);

/// Reads a scenario file and the scenarios that it extends, applies the overrides and checks the result. An override is
/// `path=value`: a dotted path, and a value that is parsed as JSON, or taken as text if it is not JSON. If two
/// overrides set the same field, the later override counts.
///
/// The field "expect" describes the run without overrides. If an override changes the run, the bounds of "expect" on
/// metrics are dropped, and the run may also end with an outcome that would be expected without the field "expect"
/// (ExpectFields).
///
/// Throws InputError whose message begins with the faulty file.
inline LoadedScenario load_scenario(const std::filesystem::path& file, std::span<const std::string> overrides = {}) {
  return load_scenario(read_scenario_text(file), overrides);
}
/// Checks a scenario given as JSON, which must not extend another scenario. Relative paths start from `directory`. The
/// InputError that this function throws names no file.
LoadedScenario read_scenario(const Json& json, const std::filesystem::path& directory);

/// Returns the scenario as JSON with every default filled in. Reading this JSON gives the same run. File paths in
/// it are relative to `directory`.
Json effective_scenario(const Scenario& scenario, const std::filesystem::path& directory);

/// Returns a hash that identifies the simulated input: FNV-1a, as 16 hexadecimal digits, over the effective
/// scenario in which the path of each file is replaced by the hash of the file's contents. `files` are the
/// scenario's files. Throws InputError if a file cannot be read.
std::string scenario_hash(Json effective, const NamedFiles& files);

}  // namespace hapbench
