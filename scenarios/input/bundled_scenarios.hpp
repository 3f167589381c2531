#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Scenarios that come with the program. They are found by name.
namespace hapbench {

/// Names of the groups. A group is a subfolder of scenarios/library.
inline constexpr const char* kScenarioGroups[] = {"thesis", "limits", "beyond", "quality", "examples"};

/// A scenario that comes with the program.
struct BundledScenario {
  std::string name;   ///< file name without extension
  std::string group;  ///< one of kScenarioGroups
  std::filesystem::path file;
};

/// Returns all bundled scenarios, in the order of kScenarioGroups and by name within a group. Throws InputError
/// if the installed folder of a group is missing.
std::vector<BundledScenario> bundled_scenarios();

/// Returns the scenario file that `argument` names: a path, or the name of a bundled scenario if no such file
/// exists. A relative path starts from `directory` (empty: the working directory). Throws InputError if neither
/// exists, or if the file is a mesh.
std::filesystem::path find_scenario(const std::string& argument, const std::filesystem::path& directory = {});

/// Returns the scenario files that the arguments name. If an argument is the name of a group, and no file has this
/// name, the argument stands for all scenarios of the group, ordered by name. find_scenario() resolves every other
/// argument and throws InputError.
std::vector<std::filesystem::path> find_scenarios(const std::vector<std::string>& arguments);

/// Returns the names of scenario files, without folder and extension. The program stores results under these names.
/// Throws InputError if two names are equal.
std::vector<std::string> names_of_scenarios(const std::vector<std::filesystem::path>& files);

}  // namespace hapbench
