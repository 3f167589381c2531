#include "scenarios/limits/stability/scene_devices.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "device_model/device_presets.hpp"
#include "scenarios/format/parts.hpp"
#include "scenarios/format/writer.hpp"
#include "scenarios/run/scene_loop.hpp"

namespace hapbench {
namespace {

/// The device of a file that is one, or of a scenario, of which nothing else is looked at.
DeviceFields read_device(const Json& file) {
  const bool is_scenario = file.contains("device");
  if (!is_scenario && !file.contains("type"))
    throw InputError(
        R"(got no device; allowed: an object such as {"type": "impedance", "handle_mass_kg": 0.1}, or a scenario with "device")");
  DeviceFields device;
  read_value(is_scenario ? file["device"] : file, is_scenario ? "/device" : "",
             [&device](Fields& f) { describe(f, device); });
  return device;
}

/// The scene's hand without its mass; null when it has none.
Json massless_hand(const ScenarioText& scene) {
  const auto hand = scene.json.find("hand");
  if (hand == scene.json.end() || !hand->is_object() || hand->value("type", Json()) != "mass_spring_damper") return {};
  Json massless = *hand;
  massless["type"] = "impedance";
  massless.erase("mass_kg");
  return massless;
}

}  // namespace

std::string delay_note(const Scenario& scenario) {
  const double delay = delay_of(scenario), step = 1e3 * scenario.time.step;
  if (!has_delay_in_samples(scenario) || delay == 0.0) return "";
  return fmt::format(
      "delay_samples: {:.4g} ({:.3g} ms in steps of {:.3g} ms); samples are time steps of the scene, not of the log that "
      "a device was identified from",
      delay, delay * step, step);
}

std::vector<ComparedDevice> compared_devices() {
  std::vector<ComparedDevice> devices = {{"ideal", R"({"type":"ideal"})"}, {"admittance", R"({"type":"admittance"})"}};
  for (const DevicePreset& preset : device_presets())
    devices.push_back({preset.name, fmt::format(R"({{"type":"impedance","preset":"{}"}})", preset.name), true,
                       preset.max_stiffness.value});
  return devices;
}

ComparedDevice device_of_file(const std::filesystem::path& file) {
  const ScenarioText text = read_scenario_text(file);
  LoadedScenario place;
  place.file = file;
  place.layers = text.layers;
  const DeviceFields device = with_file(place, [&text] { return read_device(text.json); });
  return {file.stem().string(), written(device).dump(), handle_moves_tool(device)};
}

std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor) {
  DeviceFields fields = read_device(Json::parse(device.json));
  auto* impedance = std::get_if<ImpedanceDeviceConfig>(&fields);
  if (impedance == nullptr || impedance->coulomb == 0.0) return std::nullopt;
  impedance->coulomb *= factor;
  device.json = written(fields).dump();
  device.name += fmt::format("[friction*{:g}]", factor);
  return device;
}

std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device) {
  const DevicePreset* preset = find_device_preset(Json::parse(device.json).value("preset", ""));
  if (preset == nullptr) return {};
  std::vector<ComparedDevice> ends(2, device);
  ends[0].json = written(DeviceFields(config_of(*preset, PresetEnd::soft))).dump();
  ends[0].name += "[soft]";
  ends[1].json = written(DeviceFields(config_of(*preset, PresetEnd::stiff))).dump();
  ends[1].name += "[stiff]";
  return ends;
}

std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {"device=" + device.json};
  const Json hand = device.has_place_for_mass ? Json() : massless_hand(scene);
  if (!hand.is_null()) all.push_back("hand=" + hand.dump());
  for (const std::string& override : overrides) {
    if (hand.is_null() || overridden_path(override) != "hand.mass_kg") all.push_back(override);
  }
  return all;
}

}  // namespace hapbench
