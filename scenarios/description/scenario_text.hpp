#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "scenarios/description/load_scenario.hpp"

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
  /// The file and those it extends; null when it extends none.
  std::shared_ptr<const std::vector<ScenarioLayer>> layers = nullptr;
};

/// Reads a scenario file and, over and over, the one that its field "extends" names: a file, relative to the one that
/// names it, or else a bundled scenario. The fields of each are merged over those of the scenario that it extends.
///
/// Objects merge field by field; anything else replaces what it meets, null too, which is a value like any other. An
/// object replaces one of another "type", whose fields would mean nothing in it. Of two fields that exclude each other
/// ("steps" and "duration_s") the one that is given drives out the other. "name" and "expect" are not taken over: they
/// say what that one scenario is called and shows. A relative path in a field "file" stays relative to its own file.
///
/// Throws InputError that begins with the file at fault; a chain that comes back to itself is refused.
ScenarioText read_scenario_text(const std::filesystem::path& file);

/// Applies overrides and checks the scenario, as load_scenario does with the file. For several threads.
LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides);

/// The dotted path of an override, path=value.
inline std::string_view overridden_path(std::string_view override) noexcept {
  return override.substr(0, override.find('='));
}

}  // namespace hapbench
