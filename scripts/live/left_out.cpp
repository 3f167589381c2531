// Replaces the parts of the engine that need an operating system: the folder of an installation, modules and signals.
#include <filesystem>

#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

[[noreturn]] void refuse_library() {
  throw InputError("a page loads no libraries; run this scenario with hapbench");
}

}  // namespace

/// A file of the page, or else a bundled scenario.
std::filesystem::path find_scenario(const std::string& name, const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> places = {directory / name};
  for (const char* group : kScenarioGroups)
    places.push_back(std::filesystem::path("/scenarios") / group / (name + ".json"));
  for (const auto& file : places)
    if (std::error_code error; std::filesystem::exists(file, error)) return file;
  throw InputError(name + ": no such file and no bundled scenario");
}

void require_contacts_in(const std::filesystem::path&) {
  refuse_library();
}
std::unique_ptr<ContactSource> module_contacts(const std::filesystem::path&, const std::string&, const HapbenchRun&) {
  refuse_library();
}

void throw_if_stopped() {}

}  // namespace hapbench
