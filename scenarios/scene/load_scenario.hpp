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

/// A checked scenario.
struct LoadedScenario {
  Scenario scenario;
  std::filesystem::path file;
  NamedFiles files;                    ///< that the scenario names
  std::vector<Warning> warnings;       ///< about given values without effect
  std::vector<Warning> file_warnings;  ///< about the files, once they are checked (scenarios/run/assemble.hpp)
  /// The file and those it extends as they stand, overrides in the first; empty when it extends none.
  std::vector<ScenarioLayer> layers;
};

/// Applies overrides and checks the scenario, as load_scenario does with the file. For several threads.
LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides);

/// Reads a scenario file and what it extends, applies overrides `path=value` (dotted path, value as JSON or else as
/// text; later ones win) and checks it. Expectations of the file are about the run it describes: with any field
/// overridden that changes the run, its bounds on metrics do not count, and the outcomes that count by default are
/// allowed as well as its own. Throws InputError whose message starts with the name of the file at fault.
inline LoadedScenario load_scenario(const std::filesystem::path& file, std::span<const std::string> overrides = {}) {
  return load_scenario(read_scenario_text(file), overrides);
}
/// The same from JSON in memory, which extends nothing; `directory` is what relative paths start from.
LoadedScenario read_scenario(const Json& json, const std::filesystem::path& directory);

/// The scenario with every default filled in, as JSON: reading it again gives the same run. Paths start from
/// `directory`.
Json effective_scenario(const Scenario& scenario, const std::filesystem::path& directory);

/// Identifies what is simulated: FNV-1a over the effective scenario with the contents of `files`, which are the
/// scenario's, in place of their paths, as 16 hexadecimal digits. Throws InputError.
std::string scenario_hash(Json effective, const NamedFiles& files);

}  // namespace hapbench
