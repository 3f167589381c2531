#include "scenarios/analysis/stability/compared_devices.hpp"

#include <fmt/format.h>

#include <utility>

#include "device_model/impedance_device.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/reader.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/devices.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/overrides.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

/// Reads a device from the JSON of a device, or from the field "device" of a scenario. Throws InputError.
DeviceFields read_device(const Json& file) {
  const bool is_scenario = file.contains("device");
  if (!is_scenario && !file.contains("type"))
    throw InputError(R"(got no device; allowed: an object such as {"type": "impedance", "handle_mass_kg": 0.1}, )"
                     R"(or a scenario with "device")");
  DeviceFields device;
  read_value(is_scenario ? file["device"] : file, is_scenario ? "/device" : "",
             [&device](Fields& f) { describe(f, device); });
  // In a scenario, the time step decides whether both delays are consistent (resolve_delay).
  if (!is_scenario && file.contains("delay_s") && file.contains("delay_samples"))
    fail_at(
        "/delay_s",
        "got it together with delay_samples; allowed in the file of a device: one of the two, because the number of "
        "samples depends on the time step");
  return device;
}

/// Returns the scene's hand without its mass, as a hand of type "impedance"; null if the hand has no mass.
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
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  if (device == nullptr || device->delay || device->delay_samples == 0.0) return "";
  const double delay = device->delay_samples, step = 1e3 * scenario.time.step;
  return fmt::format(
      "delay_samples: {:.4g} ({:.3g} ms in steps of {:.3g} ms); samples are time steps of the scene, not of the log "
      "that a device was identified from",
      delay, delay * step, step);
}

std::vector<ComparedDevice> compared_devices() {
  std::vector<ComparedDevice> devices = {{"ideal", {{"type", "ideal"}}}, {"admittance", {{"type", "admittance"}}}};
  for (const DevicePreset& preset : device_presets())
    devices.push_back(
        {preset.name, {{"type", "impedance"}, {"preset", preset.name}}, true, preset.max_stiffness.value});
  return devices;
}

ComparedDevice device_of_file(const std::filesystem::path& file) {
  const ScenarioText text = read_scenario_text(file);
  LoadedScenario source;
  source.file = file;
  source.layers = text.layers;
  const DeviceFields device = with_file(source, [&text] { return read_device(text.json); });
  return {file.stem().string(), written(device), handle_moves_tool(device)};
}

std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor) {
  DeviceFields fields = read_device(device.json);
  auto* impedance = std::get_if<ImpedanceDeviceConfig>(&fields);
  if (impedance == nullptr || impedance->coulomb == 0.0) return std::nullopt;
  impedance->coulomb *= factor;
  device.json = written(fields);
  device.name += fmt::format("[friction*{:g}]", factor);
  return device;
}

std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device) {
  std::vector<ComparedDevice> ends;
  const DevicePreset* preset = find_device_preset(device.json.value("preset", ""));
  if (preset == nullptr) return ends;
  for (const auto& [end, mark] : {std::pair(PresetVariant::soft, "[soft]"), {PresetVariant::stiff, "[stiff]"}}) {
    ends.push_back(device);
    ends.back().json = written(DeviceFields(config_of(*preset, end)));
    ends.back().name += mark;
  }
  return ends;
}

std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {"device=" + device.json.dump()};
  const Json hand = device.has_place_for_mass ? Json() : massless_hand(scene);
  if (!hand.is_null()) all.push_back("hand=" + hand.dump());
  for (const std::string& override : overrides)
    if (hand.is_null() || overridden_path(override) != "hand.mass_kg") all.push_back(override);
  return all;
}

}  // namespace hapbench
