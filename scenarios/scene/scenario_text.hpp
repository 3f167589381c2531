#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// Reads a scenario file and the files that it extends, unchecked.
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

/// Reads a scenario file and, over and over, the one that its field "extends" names: a file, relative to the one that
/// names it, or else a bundled scenario. Its fields are merged over those of the scenario that it extends: objects
/// field by field, but one of another "type" replaces the other, as does anything else, null too. Of two fields that
/// exclude each other ("steps" and "duration_s") the one that is given drives out the other. "name" and "expect" are
/// not taken over. A relative path in a field "file" stays relative to its own file. Throws InputError that begins with
/// the file at fault, also for a chain that comes back to itself.
ScenarioText read_scenario_text(const std::filesystem::path& file);

}  // namespace hapbench
