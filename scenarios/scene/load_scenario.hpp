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

/// The field that names another scenario, over whose fields those of the file are merged.
inline constexpr const char* kExtends = "extends";

/// A scenario file as it stands.
struct ScenarioLayer {
  std::filesystem::path file;
  Json json;
};

/// A scenario file with what it extends filled in, for loading it several times with different overrides.
struct ScenarioText {
  std::filesystem::path file;
  Json json;
  std::vector<ScenarioLayer> layers = {};  ///< the file and those it extends; empty when it extends none
};

/// A scenario whose fields are checked. Its files are not read yet (CheckedScenario in
/// scenarios/run/checked_scenario.hpp).
struct LoadedScenario {
  Scenario scenario;
  std::filesystem::path file;
  NamedFiles files;               ///< that the scenario names
  std::vector<Warning> warnings;  ///< about given values without effect
  /// The file and those it extends as they stand, overrides in the first; empty when it extends none.
  std::vector<ScenarioLayer> layers;
};

/// Reads a scenario file and, over and over, the one that its field "extends" names: a file, relative to the one that
/// names it, or else a bundled scenario. Its fields are merged over those of the scenario that it extends: objects
/// field by field, but one of another "type" replaces the other, as does anything else, null too. Of two fields that
/// exclude each other ("steps" and "duration_s") the one that is given drives out the other. "name" and "expect" are
/// not taken over. A relative path in a field "file" stays relative to its own file. Throws InputError that begins with
/// the file at fault, also for a chain that comes back to itself.
ScenarioText read_scenario_text(const std::filesystem::path& file);

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

/// The dotted path of an override, path=value.
inline std::string_view overridden_path(std::string_view override) noexcept {
  return override.substr(0, override.find('='));
}

/// The file that the value at a JSON pointer comes from: the scenario's own, or one that it extends.
std::filesystem::path file_of(const LoadedScenario& loaded, const std::string& pointer);

/// The warnings with the file and the pointer of each in front, for people.
std::vector<std::string> with_files(const LoadedScenario& loaded, const std::vector<Warning>& warnings);

/// Throws the error again with the file in front of each fault.
[[noreturn]] void rethrow_with_file(const InputError& error, const std::filesystem::path& file);
/// The same with the scenario's file, or the one it extends that has the fault.
[[noreturn]] void rethrow_with_file(const InputError& error, const LoadedScenario& loaded);

/// Calls `work` and throws an InputError of it again as rethrow_with_file does with a file or a loaded scenario.
template <class Place, class Work>
auto with_file(const Place& place, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    rethrow_with_file(error, place);
  }
}

/// The scenario with every default filled in, as JSON: reading it again gives the same run. Paths start from
/// `directory`.
Json effective_scenario(const Scenario& scenario, const std::filesystem::path& directory);

/// Identifies what is simulated: FNV-1a over the effective scenario with the contents of `files`, which are the
/// scenario's, in place of their paths, as 16 hexadecimal digits. Throws InputError.
std::string scenario_hash(Json effective, const NamedFiles& files);

}  // namespace hapbench
