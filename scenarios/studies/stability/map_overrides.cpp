#include "scenarios/studies/stability/map_overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

constexpr std::string_view kAnyAlgorithm = "summation";  // no algorithm changes device or hand
constexpr std::string_view kTimeStep = "time.step_s";
constexpr std::string_view kWholeDevice = "device";

std::string_view section_of(std::string_view override) {
  const std::string_view path = overridden_path(override);
  return path.substr(0, path.find('.'));
}

bool has_own_device(const StabilityMap& map) {
  return handle_moves_tool(map.scene(map.x.low, map.y.low, kAnyAlgorithm).device) && !map.in_units_of_device;
}

void require_map_of_device(const StabilityMap& map) {
  if (has_own_device(map)) return;
  std::vector<std::string> names;
  for (const StabilityMap& other : stability_maps()) {
    if (has_own_device(other)) names.emplace_back(other.name);
  }
  throw InputError(
      fmt::format("--set: got an override for the map \"{}\"; allowed: for {}", map.name, quoted_list(names)));
}

/// The value that a scene of the map has at a dotted path; null without.
Json field_at(const StabilityMap& map, double x, double y, std::string_view path) {
  const Json scene = effective_scenario(map.scene(x, y, kAnyAlgorithm), {});
  Json::json_pointer at;
  for (const std::string_view key : parts_of(path, '.')) at /= std::string(key);
  return scene.contains(at) ? scene.at(at) : Json();
}

void require_field(const StabilityMap& map, std::string_view override) {
  const std::string_view path = overridden_path(override), section = section_of(override);
  if (section != "device" && section != "hand" && path != kTimeStep) {
    throw InputError(fmt::format(
        "--set: got {} with --map; allowed: {} and fields of device and hand, such as device.handle_mass_kg", path,
        kTimeStep));
  }
  if (path == kWholeDevice) return;  // but for what an axis varies
  if (path == "device.type" || path == "device.preset") {
    throw InputError(fmt::format(
        R"(--set: got {} with --map, whose device has all its numbers; allowed: device as a whole, such as 'device={{"type":"impedance","preset":"touch"}}')",
        path));
  }
  const Json value = field_at(map, map.x.low, map.y.low, path);
  for (const MapAxis* axis : {&map.x, &map.y}) {
    const bool along_x = axis == &map.x;
    if (field_at(map, along_x ? map.x.high : map.x.low, along_x ? map.y.low : map.y.high, path) == value) continue;
    throw InputError(
        fmt::format("--set: got {}, which {} of the map \"{}\" varies; allowed: other fields of device and hand", path,
                    axis->name, map.name));
  }
}

bool gives_impedance_device(const std::string& override) {
  const std::string value = override.substr(override.find('=') + 1);
  if (overridden_path(override) != kWholeDevice || !Json::accept(value)) return false;
  const Json device = parse_json(value);
  return device.is_object() && device.value("type", Json()) == "impedance";
}

/// What the axes vary of the device, as overrides with the values that a scene of the map has.
std::vector<std::string> device_at(const StabilityMap& map, const Json& scene) {
  std::vector<std::string> varied;
  for (const auto& field : scene.at(kWholeDevice).items()) {
    const std::string path = fmt::format("{}.{}", kWholeDevice, field.key());
    if (field_at(map, map.x.low, map.y.low, path) != field_at(map, map.x.high, map.y.high, path))
      varied.push_back(fmt::format("{}={}", path, field.value().dump()));
  }
  return varied;
}

}  // namespace

void require_overridable(const StabilityMap& map, const std::vector<std::string>& overrides) {
  if (overrides.empty()) return;
  require_map_of_device(map);
  for (const std::string& override : overrides) require_field(map, override);
  const Scenario scene = with_overrides(map, map.scene(map.x.low, map.y.low, kAnyAlgorithm), overrides);
  if (!handle_moves_tool(scene.device))
    throw InputError("--set: got a device of another type with --map; allowed: \"impedance\"");
}

Scenario with_overrides(const StabilityMap& map, Scenario scenario, const std::vector<std::string>& overrides) {
  ScenarioText text{fmt::format("map {}", map.name), effective_scenario(scenario, {})};
  // Numbers of a search for an edge go beyond what a file may hold: what no override is about stays out of it.
  const bool has_hand =
      std::any_of(overrides.begin(), overrides.end(), [](const auto& o) { return section_of(o) == "hand"; });
  std::vector<std::string> all = overrides;
  if (std::any_of(overrides.begin(), overrides.end(), gives_impedance_device)) {
    const std::vector<std::string> varied = device_at(map, text.json);
    all.insert(all.end(), varied.begin(), varied.end());
  }
  text.json.erase("rendering");
  if (!has_hand) text.json.erase("hand");
  const LoadedScenario loaded = load_scenario(text, all);
  scenario.time.step = loaded.scenario.time.step;
  scenario.device = loaded.scenario.device;
  if (has_hand) scenario.hand = loaded.scenario.hand;
  return scenario;
}

}  // namespace hapbench
