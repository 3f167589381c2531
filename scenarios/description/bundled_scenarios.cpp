#include "scenarios/description/bundled_scenarios.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/mesh_file.hpp"

namespace hapbench {

namespace fs = std::filesystem;

std::vector<BundledScenario> bundled_scenarios() {
  std::vector<BundledScenario> found;
  const fs::path folder = installed_folder("scenarios");
  for (const char* group : kScenarioGroups) {
    std::error_code error;
    const fs::directory_iterator entries(folder / group, error);
    if (error) throw InputError(fmt::format("{}: {}", (folder / group).string(), error.message()));
    for (const auto& entry : entries) {
      if (entry.path().extension() == ".json") found.push_back({entry.path().stem().string(), group, entry.path()});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const BundledScenario& a, const BundledScenario& b) {
    return a.group == b.group ? a.name < b.name : false;
  });
  return found;
}

fs::path find_scenario(const std::string& argument, const fs::path& directory) {
  std::error_code error;
  const fs::path file = directory / argument;
  if (fs::exists(file, error)) {
    if (is_mesh_name(file) && !fs::is_directory(file, error))
      throw InputError(fmt::format("{}: is a mesh; allowed: a scenario, as \"hapbench new mesh --from {}\" writes one",
                                   argument, argument));
    return file;
  }
  std::vector<std::string> names;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    if (bundled.name == argument) return bundled.file;
    names.push_back(bundled.name);
  }
  if (fs::exists(file.string() + ".json", error))
    throw InputError(fmt::format("{}: no such file and no bundled scenario; there is {}.json", argument, argument));
  if (argument.find('=') != std::string::npos)
    throw InputError(
        fmt::format("{}: no such file and no bundled scenario; a field is overridden by --set {}", argument, argument));
  const std::string stem = fs::path(argument).stem().string();
  throw InputError(fmt::format("{}: no such file and no bundled scenario{}; \"hapbench describe scenarios\" shows them",
                               argument, nearest_name_hint(stem, names)));
}

std::vector<fs::path> find_scenarios(const std::vector<std::string>& arguments) {
  std::vector<fs::path> files;
  for (const std::string& argument : arguments) {
    const auto is_group = [&argument](const char* group) { return argument == group; };
    std::error_code error;
    if (std::none_of(std::begin(kScenarioGroups), std::end(kScenarioGroups), is_group) || fs::exists(argument, error)) {
      files.push_back(find_scenario(argument));
      continue;
    }
    for (const BundledScenario& scenario : bundled_scenarios()) {
      if (scenario.group == argument) files.push_back(scenario.file);
    }
  }
  return files;
}

}  // namespace hapbench
