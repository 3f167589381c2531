#include "scenarios/studies/stability/map_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapbench {
namespace {

/// Springs under a tool that is let go a millimetre away, in no special direction, so that every mode of the springs
/// is excited.
Scenario springs(std::vector<SpringGroup> groups, double K, std::string_view algorithm) {
  Scenario scenario;
  scenario.name = "stability_map";
  scenario.time.steps = kMapSteps;
  scenario.environment.emplace<SpringsEnvironment>().groups = std::move(groups);
  scenario.initial.position = {0.6e-3, 0.64e-3, 0.48e-3};
  scenario.rendering.stiffness = K;
  scenario.rendering.mass = 0.1;
  return with_algorithm(std::move(scenario), algorithm);
}

Scenario one_spring(double K, std::string_view algorithm) {
  return springs({{Vec3::UnitX(), 1}}, K, algorithm);
}

Scenario time_step_scene(double step, double K, std::string_view algorithm) {
  Scenario scenario = one_spring(K, algorithm);
  scenario.time.step = step;
  return scenario;
}

Scenario mass_scene(double mass, double K, std::string_view algorithm) {
  Scenario scenario = one_spring(K, algorithm);
  scenario.rendering.mass = mass;
  return scenario;
}

Scenario damping_ratio_scene(double zeta, double K, std::string_view algorithm) {
  Scenario scenario = one_spring(K, algorithm);
  scenario.rendering.damping_ratio = zeta;
  return scenario;
}

Scenario contacts_scene(double count, double K, std::string_view algorithm) {
  return springs({{Vec3::UnitX(), static_cast<std::int64_t>(count)}}, K, algorithm);
}

/// Two faces with this angle between them, open upwards: 0 is a slit, pi a floor.
Scenario wedge_scene(double angle, double K, std::string_view algorithm) {
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
  return springs({{{c, -s, 0.0}, 1}, {{-c, -s, 0.0}, 1}}, K, algorithm);
}

/// The hand presses the handle of the admittance device against a wall that only pushes, towards a place 3 mm inside.
Scenario device_scene(double delay_samples, double hand_stiffness, std::string_view algorithm) {
  Scenario scenario = one_spring(20'000.0, algorithm);
  std::get<SpringsEnvironment>(scenario.environment).bilateral = false;
  scenario.initial.position = Vec3::Zero();
  ImpedanceHandFields hand;
  hand.stiffness = hand_stiffness;
  hand.target[0] = 0.003;
  scenario.hand = hand;
  AdmittanceDeviceConfig device;
  device.servo.delay = static_cast<std::size_t>(delay_samples);
  scenario.device = device;
  return scenario;
}

using Scale = MapAxis::Scale;
constexpr MapAxis kStiffness = {"stiffness_N_per_m", 1e3, 1e7, Scale::logarithmic};

constexpr StabilityMap kMaps[] = {
    {"time_step",
     "K over the time step, one spring",
     {"time_step_s", 5e-5, 5e-3, Scale::logarithmic},
     kStiffness,
     time_step_scene,
     nullptr},
    {"mass",
     "K over the mass of the virtual tool, one spring",
     {"mass_kg", 0.01, 10.0, Scale::logarithmic},
     kStiffness,
     mass_scene,
     nullptr},
    {"damping_ratio",
     "K over zeta, one spring",
     {"damping_ratio", 0.0, 3.0, Scale::linear},
     kStiffness,
     damping_ratio_scene,
     nullptr},
    {"contacts",
     "K over the number of parallel contacts",
     {"contacts", 1.0, 100.0, Scale::logarithmic, true},
     kStiffness,
     contacts_scene,
     nullptr},
    {"wedge",
     "K over the angle between two faces",
     {"wedge_angle_rad", 0.0, std::numbers::pi, Scale::linear},
     kStiffness,
     wedge_scene,
     nullptr},
    {"device",
     "stiffness of the hand over the delay of the servo, K = 20 000 N/m, admittance device",
     {"delay_samples", 0.0, 16.0, Scale::linear, true},
     {"hand_stiffness_N_per_m", 30.0, 3e5, Scale::logarithmic},
     device_scene,
     "servo, handle and hand are part of the loop"},
};

}  // namespace

double MapAxis::at(std::size_t i, std::size_t n) const noexcept {
  const double part = n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 0.0;
  const double value = scale == Scale::linear ? low + part * (high - low) : low * std::pow(high / low, part);
  return whole ? std::round(value) : value;
}

std::span<const StabilityMap> stability_maps() {
  return kMaps;
}

const StabilityMap* find_stability_map(std::string_view name) {
  const auto found = std::find_if(std::begin(kMaps), std::end(kMaps), [name](const auto& m) { return m.name == name; });
  return found == std::end(kMaps) ? nullptr : &*found;
}

}  // namespace hapbench
