#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "scenarios/description/extends.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// A scenario file with what it extends filled in, for loading it several times with different overrides.
struct ScenarioText {
  std::filesystem::path file;
  Json json;
  /// The file and those it extends; null when it extends none.
  std::shared_ptr<const std::vector<ScenarioLayer>> layers = nullptr;
};

/// What `load_scenario` of a file does, in two steps. Both throw InputError; the second may be called from several
/// threads.
ScenarioText read_scenario_text(const std::filesystem::path& file);
LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides);

/// The dotted path of an override, path=value.
inline std::string_view overridden_path(std::string_view override) noexcept {
  return override.substr(0, override.find('='));
}

}  // namespace hapbench
