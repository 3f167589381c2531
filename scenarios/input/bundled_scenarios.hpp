#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Finds the folders that come with the program, and the scenarios in them by their names.
namespace hapbench {

/// A folder of the files that come with hapbench: the first existing share/hapbench/NAME of
///   - the folders above the shared object that contains this library: libhapbench.so, a Python module;
///   - the parent of the running program's folder: hapbench, installed or in its build tree;
///   - the place that the build defines, for projects that use this one by find_package or add_subdirectory.
/// Throws InputError when there is none.
std::filesystem::path installed_folder(const std::string& name);

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
