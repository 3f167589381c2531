#include "scenarios/studies/stability/device_limits.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "device_model/device_presets.hpp"

namespace hapbench {
namespace {

constexpr const char* kStiffness = "rendering.stiffness_N_per_m";

/// The scene's hand without its mass; null when it has none.
Json massless_hand(const ScenarioText& scene) {
  const auto hand = scene.json.find("hand");
  if (hand == scene.json.end() || !hand->is_object() || hand->value("type", Json()) != "mass_spring_damper") return {};
  Json massless = *hand;
  massless["type"] = "impedance";
  massless.erase("mass_kg");
  return massless;
}

/// In the order of the answers.
DeviceLimit question_for(const DeviceQuestion& asked, std::size_t device, std::size_t scene) {
  const std::vector<std::string> overrides = overrides_on(asked.devices[device], asked.scenes[scene], asked.overrides);
  DeviceLimit limit{device, scene, limit_question(asked.scenes[scene], overrides, kStiffness, {}), {}};
  limit.question.most_vibration = asked.most_vibration;
  limit.question.resolution = asked.resolution;
  return limit;
}

}  // namespace

std::vector<ComparedDevice> compared_devices() {
  std::vector<ComparedDevice> devices = {{"ideal", R"({"type":"ideal"})"}, {"admittance", R"({"type":"admittance"})"}};
  for (const DevicePreset& preset : device_presets()) {
    devices.push_back({preset.name, fmt::format(R"({{"type":"impedance","preset":"{}"}})", preset.name), true,
                       preset.max_stiffness.value});
  }
  return devices;
}

std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {"device=" + device.json};
  const Json hand = device.has_place_for_mass ? Json() : massless_hand(scene);
  if (!hand.is_null()) all.push_back("hand=" + hand.dump());
  for (const std::string& override : overrides) {
    if (hand.is_null() || !override.starts_with("hand.mass_kg=")) all.push_back(override);
  }
  return all;
}

std::vector<DeviceLimit> device_limits(const DeviceQuestion& asked, const JobOptions& jobs) {
  std::vector<DeviceLimit> limits;
  for (std::size_t device = 0; device < asked.devices.size(); ++device) {
    for (std::size_t scene = 0; scene < asked.scenes.size(); ++scene) {
      limits.insert(limits.end(), asked.algorithms.size(), question_for(asked, device, scene));
    }
  }
  for_each_job(limits.size(), jobs, [&](std::size_t i) {
    DeviceLimit& limit = limits[i];
    const ScenarioText& scene = asked.scenes[limit.scene];
    const auto overrides = overrides_on(asked.devices[limit.device], scene, asked.overrides);
    limit.limit =
        field_limits(scene, overrides, {asked.algorithms[i % asked.algorithms.size()]}, limit.question, {}).front();
  });
  return limits;
}

}  // namespace hapbench
