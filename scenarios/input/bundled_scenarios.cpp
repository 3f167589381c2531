#include "scenarios/input/bundled_scenarios.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/shell_words.hpp"

namespace hapbench {

namespace fs = std::filesystem;

std::vector<BundledScenario> bundled_scenarios() {
  std::vector<BundledScenario> found;
  const fs::path folder = installed_folder("scenarios/library");
  for (const char* group : kScenarioGroups) {
    std::error_code error;
    const fs::directory_iterator entries(folder / group, error);
    if (error) throw InputError(fmt::format("{}: {}", (folder / group).string(), error.message()));
    const auto first = static_cast<std::ptrdiff_t>(found.size());
    for (const auto& entry : entries) {
      if (entry.path().extension() == ".json") found.push_back({entry.path().stem().string(), group, entry.path()});
    }
    std::ranges::sort(found.begin() + first, found.end(), {}, &BundledScenario::name);
  }
  return found;
}

/// Returns the names of the bundled studies.
static std::vector<std::string> study_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(installed_folder("scenarios/library") / "studies", error))
    names.push_back(entry.path().stem().string());
  std::ranges::sort(names);  // the entries of a folder have no defined order
  return names;
}

fs::path find_scenario(const std::string& argument, const fs::path& directory) {
  // If the argument is an existing file, return it. Refuse a mesh.
  std::error_code error;
  fs::path file = directory / argument;
  const bool is_folder = fs::is_directory(file, error);
  if (!is_folder && fs::exists(file, error)) {
    if (is_mesh_name(file))
      throw InputError(fmt::format("{}: is a mesh; allowed: a scenario; \"hapbench new mesh --from {}\" writes one",
                                   argument, shell_file(argument)));
    return file;
  }
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", argument, error.message()));
  // Search the bundled scenarios.
  std::vector<std::string> names;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    if (bundled.name == argument) return bundled.file;
    names.push_back(bundled.name);
  }
  // The argument names neither a file nor a scenario: report the most likely mistake.
  if (is_folder)
    throw InputError(argument + ": is a directory; allowed: a scenario file or the name of a bundled scenario");
  const std::string missing = argument + ": no such file and no bundled scenario";
  if (fs::exists(file.string() + ".json", error)) throw InputError(missing + "; there is " + argument + ".json");
  if (const fs::path near = fs::path(argument).replace_extension(".json"); fs::exists(directory / near, error))
    throw InputError(missing + "; there is " + near.string());
  if (argument.find('=') != std::string::npos)
    throw InputError(missing + "; a field is overridden by --set " + shell_word(argument));
  const std::string stem = fs::path(argument).stem().string();
  if (nearest_name(stem, names).empty()) {
    if (const std::string study = nearest_name_hint(stem, study_names()); !study.empty())
      throw InputError(missing + study + ", a study; \"hapbench describe studies\" shows them");
  }
  throw InputError(missing + nearest_name_hint(stem, names) + "; \"hapbench describe scenarios\" shows them");
}

std::vector<fs::path> find_scenarios(const std::vector<std::string>& arguments) {
  std::vector<fs::path> files;
  for (const std::string& argument : arguments) {
    // Resolve an argument that is not the name of a group, or that is also the name of a file.
    std::error_code error;
    if (std::ranges::find(kScenarioGroups, argument) == std::end(kScenarioGroups) || fs::exists(argument, error)) {
      files.push_back(find_scenario(argument));
      continue;
    }
    // Add all scenarios of the group.
    for (const BundledScenario& scenario : bundled_scenarios()) {
      if (scenario.group == argument) files.push_back(scenario.file);
    }
  }
  return files;
}

std::vector<std::string> names_of_scenarios(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) {
    const std::string name = file.stem().string();
    if (std::ranges::find(names, name) != names.end())
      throw InputError(fmt::format("{}: a second scenario named \"{}\"; allowed: each name once", file.string(), name));
    names.push_back(name);
  }
  return names;
}

}  // namespace hapbench
