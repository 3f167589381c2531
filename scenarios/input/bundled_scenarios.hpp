#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// The scenarios that come with the program, found by their names.
namespace hapbench {

inline constexpr const char* kScenarioGroups[] = {"thesis", "limits", "beyond", "quality", "examples"};

/// A bundled scenario.
struct BundledScenario {
  std::string name;   ///< file name without extension
  std::string group;  ///< thesis, limits, beyond, quality, examples
  std::filesystem::path file;
};

/// All of them, by group and name. Throws InputError when their folders are not beside the program.
std::vector<BundledScenario> bundled_scenarios();

/// The file a scenario argument means: a path, relative ones starting from `directory`, or else the name of a bundled
/// scenario. Throws InputError.
std::filesystem::path find_scenario(const std::string& argument, const std::filesystem::path& directory = {});

/// The files that several arguments mean: what find_scenario finds, and for the name of a group all that is in it, by
/// name. A file of that name goes before the group. Throws InputError.
std::vector<std::filesystem::path> find_scenarios(const std::vector<std::string>& arguments);

/// The names of scenario files, after which results are named. Throws InputError when two are the same.
std::vector<std::string> names_of_scenarios(const std::vector<std::filesystem::path>& files);

}  // namespace hapbench
