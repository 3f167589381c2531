// Replaces the parts of the engine that need an operating system: the folder of an installation, plugins and signals.
#include <filesystem>

#include "algorithms/plugin/plugin_call.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/plugins/load_plugin.hpp"
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

const HapbenchContactSource& contact_plugin(const std::filesystem::path&) {
  refuse_library();
}
PluginCall::PluginCall(const char*, const char*) noexcept {}
PluginCall::~PluginCall() = default;

void throw_if_stopped() {}

}  // namespace hapbench
