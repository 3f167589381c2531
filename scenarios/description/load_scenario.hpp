#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scenarios/description/named_files.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// A checked scenario.
struct LoadedScenario {
  Scenario scenario;
  std::filesystem::path file;
  NamedFiles files;                   ///< that the scenario names
  std::vector<std::string> warnings;  ///< given values that the algorithm's definition overrides, with file and pointer
};

/// Throws the error again with the file in front.
[[noreturn]] void rethrow_with_file(const InputError& error, const std::filesystem::path& file);

/// Reads a scenario file, applies overrides `path=value` (dotted path, value as JSON or else as text; later ones win)
/// and checks it. Expectations of the file are about the run it describes: with any field overridden that changes the
/// run, its bounds on metrics do not count, and beside its outcomes those count that count by default. Throws
/// InputError whose message starts with the file's name.
LoadedScenario load_scenario(const std::filesystem::path& file, std::span<const std::string> overrides = {});

/// The same from JSON in memory; `directory` is what relative paths start from.
LoadedScenario read_scenario(const Json& json, const std::filesystem::path& directory);

/// Calls `work` and puts the scenario's file in front of the message of an InputError.
template <class Work>
auto with_file(const LoadedScenario& loaded, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    rethrow_with_file(error, loaded.file);
  }
}

/// The scenario with every default filled in, as JSON: reading it again gives the same run. File paths are rewritten to
/// start from `directory`.
Json effective_scenario(const Scenario& scenario, const std::filesystem::path& directory);

/// The environment with every default filled in, with hashes of the contents of named files in place of their paths:
/// equal for equal point shells. Throws InputError.
Json environment_content(const Scenario& scenario, const NamedFiles& files);

/// The whole JSON Schema (draft 7) that scenarios/scenario.schema.json holds.
Json scenario_schema();

/// Identifies what is simulated: FNV-1a over the effective scenario, with the contents of named files in place of their
/// paths, as 16 hexadecimal digits. Throws InputError.
std::string scenario_hash(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
