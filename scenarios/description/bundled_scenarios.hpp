#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// The scenarios in the tree, known by their names.
namespace hapbench {

/// A bundled scenario.
struct BundledScenario {
  std::string name;   ///< file name without extension
  std::string group;  ///< thesis, limits, beyond, examples
  std::filesystem::path file;
};

/// The scenarios that come with hapbench, by group and name.
std::vector<BundledScenario> bundled_scenarios();

/// The file a scenario argument means: a path, relative ones starting from `directory`, or else the name of a bundled
/// scenario. Throws InputError.
std::filesystem::path find_scenario(const std::string& argument, const std::filesystem::path& directory = {});

}  // namespace hapbench
