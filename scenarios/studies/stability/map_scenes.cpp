#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"
#include "scenarios/studies/stability/stability_map.hpp"
#include "sim/core/math.hpp"

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
  const double c = math::cos(0.5 * angle), s = math::sin(0.5 * angle);
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

/// A handle of an impedance device at 1 kHz, with a wall on both sides, since limits are about linear loops: a wall
/// that only pushes lets go of the handle. 100 g, 0.5 N s/m (ours): K stays passive up to 2 b / T = 1000 N/m.
Scenario handle_scene(double K, double B, std::string_view algorithm) {
  Scenario scenario = one_spring(K, algorithm);
  scenario.time.step = 0.001;
  scenario.rendering.damping = B;
  ImpedanceDeviceConfig device;
  device.handle_mass = 0.1;
  device.viscous = 0.5;
  scenario.device = device;
  return scenario;
}

ImpedanceDeviceConfig& handle_of(Scenario& scenario) {
  return std::get<ImpedanceDeviceConfig>(scenario.device);
}

constexpr double kWallDamping = 5.0;  // [N s/m]

Scenario z_width_scene(double B, double K, std::string_view algorithm) {
  return handle_scene(K, B, algorithm);
}

Scenario delay_scene(double samples, double K, std::string_view algorithm) {
  Scenario scenario = handle_scene(K, kWallDamping, algorithm);
  handle_of(scenario).delay_samples = samples;
  return scenario;
}

Scenario velocity_filter_scene(double cutoff, double K, std::string_view algorithm) {
  Scenario scenario = handle_scene(K, kWallDamping, algorithm);
  handle_of(scenario).velocity_filter = LowPassFilter{cutoff};
  return scenario;
}

Scenario hand_scene(double hand_stiffness, double K, std::string_view algorithm) {
  Scenario scenario = handle_scene(K, kWallDamping, algorithm);
  MassSpringDamperHandFields hand;
  hand.mass = 0.2;
  hand.spring.stiffness = hand_stiffness;
  hand.spring.damping = 2.0;
  scenario.hand = hand;
  return scenario;
}

/// Lets a hand push so that the wall balances it between two steps q of the encoder, where friction has to hold the
/// handle: at a step, the wall does.
void push_between_steps(Scenario& scenario, double q) {
  ForceHandFields hand;
  hand.force[0] = 2.5 * scenario.rendering.stiffness * q;
  scenario.hand = hand;
  handle_of(scenario).encoder_step = q;
}

Scenario encoder_step_scene(double step, double K, std::string_view algorithm) {
  Scenario scenario = handle_scene(K, 0.0, algorithm);
  scenario.initial.position *= 10.0;  // so that it is not friction that keeps the motion from growing
  handle_of(scenario).coulomb = 0.02;
  push_between_steps(scenario, step);
  return scenario;
}

/// Begins six steps of the encoder away from rest.
Scenario friction_scene(double damping, double friction, std::string_view algorithm) {
  constexpr double kWallStiffness = 1000.0, kStep = 1e-6;  // K, q
  Scenario scenario = handle_scene(kWallStiffness, 0.0, algorithm);
  scenario.initial.position = -3.3 * kStep * Vec3::UnitX();
  handle_of(scenario).viscous = 0.5 * damping * kWallStiffness * scenario.time.step;
  handle_of(scenario).coulomb = 0.5 * friction * kWallStiffness * kStep;
  push_between_steps(scenario, kStep);
  return scenario;
}

using Scale = MapAxis::Scale;
constexpr const char* kStiffnessName = StabilityMap::kStiffnessAxis.data();
constexpr MapAxis kSpringStiffness = {kStiffnessName, 1e3, 1e7, Scale::logarithmic};
constexpr MapAxis kHandleStiffness = {kStiffnessName, 1e2, 1e5, Scale::logarithmic};

constexpr StabilityMap kMaps[] = {
    {.name = "time_step",
     .summary = "K over the time step, one spring",
     .x = {"time_step_s", 5e-5, 5e-3, Scale::logarithmic},
     .y = kSpringStiffness,
     .scene = time_step_scene},
    {.name = "mass",
     .summary = "K over the mass of the virtual tool, one spring",
     .x = {"mass_kg", 0.01, 10.0, Scale::logarithmic},
     .y = kSpringStiffness,
     .scene = mass_scene},
    {.name = "damping_ratio",
     .summary = "K over zeta, one spring",
     .x = {"damping_ratio", 0.0, 3.0, Scale::linear},
     .y = kSpringStiffness,
     .scene = damping_ratio_scene},
    {.name = "contacts",
     .summary = "K over the number of parallel contacts",
     .x = {"contacts", 1.0, 100.0, Scale::logarithmic, true},
     .y = kSpringStiffness,
     .scene = contacts_scene},
    {.name = "wedge",
     .summary = "K over the angle between two faces",
     .x = {"wedge_angle_rad", 0.0, std::numbers::pi, Scale::linear},
     .y = kSpringStiffness,
     .scene = wedge_scene},
    {.name = "device",
     .summary = "stiffness of the hand over the delay of the servo, K = 20 000 N/m, admittance device",
     .x = {"delay_samples", 0.0, 16.0, Scale::linear, true},
     .y = {"hand_stiffness_N_per_m", 30.0, 3e5, Scale::logarithmic},
     .scene = device_scene,
     .edge = MapEdge::largest_at_rest},
    {.name = "z_width",
     .summary = "K over B of one wall on both sides, impedance device of 100 g and 0.5 N s/m at 1 kHz",
     .x = {"wall_damping_N_s_per_m", 0.1, 150.0, Scale::logarithmic},
     .y = kHandleStiffness,
     .scene = z_width_scene},
    {.name = "delay",
     .summary = "K over the delay of the force, B = 5 N s/m, impedance device as for z_width",
     .x = {"delay_samples", 0.0, 8.0, Scale::linear},
     .y = kHandleStiffness,
     .scene = delay_scene},
    {.name = "velocity_filter",
     .summary = "K over the cut-off of the velocity's low-pass, B = 5 N s/m, impedance device as for z_width",
     .x = {"cutoff_Hz", 20.0, 500.0, Scale::logarithmic},
     .y = kHandleStiffness,
     .scene = velocity_filter_scene},
    {.name = "hand",
     .summary =
         "K over the stiffness of a passive hand of 200 g and 2 N s/m, B = 5 N s/m, impedance device as for z_width",
     .x = {"hand_stiffness_N_per_m", 10.0, 1e4, Scale::logarithmic},
     .y = kHandleStiffness,
     .scene = hand_scene},
    {.name = "encoder_step",
     .summary = "K over the encoder's step, B = 0, impedance device as for z_width with 0.02 N of Coulomb friction",
     .x = {"encoder_step_m", 1e-6, 1e-3, Scale::logarithmic},
     .y = kHandleStiffness,
     .scene = encoder_step_scene,
     .edge = MapEdge::largest_at_rest,
     .friction_stops = true},
    {.name = "friction_quantisation",
     .summary =
         "Coulomb friction over viscous friction, in units of what the encoder and the sampling of a wall need, B = 0, "
         "impedance device as for z_width",
     // No grid has the value 1, where a run neither comes to rest nor goes on.
     .x = {"2b_over_KT", 0.12, 12.0, Scale::logarithmic},
     .y = {"2c_over_Kq", 0.12, 12.0, Scale::logarithmic},
     .scene = friction_scene,
     .edge = MapEdge::smallest_at_rest,
     .far = 1000.0,
     .friction_stops = true,
     .in_units_of_device = true},
};

}  // namespace

double MapAxis::at(std::size_t i, std::size_t n) const noexcept {
  const double part = n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 0.0;
  const double value = scale == Scale::linear ? low + part * (high - low) : low * math::pow(high / low, part);
  return whole ? std::round(value) : value;
}

std::span<const StabilityMap> stability_maps() {
  return kMaps;
}

const StabilityMap* find_stability_map(std::string_view name) {
  const auto found = std::find_if(std::begin(kMaps), std::end(kMaps), [name](const auto& m) { return m.name == name; });
  return found == std::end(kMaps) ? nullptr : &*found;
}

namespace {

constexpr std::string_view kAnyAlgorithm = "summation";  // no algorithm changes device or hand
constexpr std::string_view kTimeStep = "time.step_s";
constexpr std::string_view kWholeDevice = "device";
constexpr std::string_view kForceStage = "rendering.force_stage";
constexpr std::string_view kFriction = "rendering.friction";

std::string_view section_of(std::string_view override) {
  const std::string_view path = overridden_path(override);
  return path.substr(0, path.find('.'));
}

bool is_below(std::string_view field, std::string_view override) {
  return overridden_path(override).substr(0, field.size()) == field;
}
/// Overrides of what no axis varies.
bool is_of_rendering(std::string_view override) {
  return is_below(kForceStage, override) || is_below(kFriction, override);
}

/// Throws InputError unless dry friction holds the tool of the scene on one wall, as a linear loop.
void require_held(const StabilityMap& map, const Scenario& scenario) {
  const auto fail = [&map](const char* allowed) {
    throw InputError(fmt::format("--set: got {} for the map \"{}\"; allowed: {}", kFriction, map.name, allowed));
  };
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  if (!scenario.rendering.dry_friction) fail(R"({"type": "dry", ...}, which holds the tool)");
  if (std::get<SpringsEnvironment>(scenario.environment).groups.size() != 1) fail("for maps of one wall");
  if (!std::holds_alternative<NoHandFields>(scenario.hand) &&
      !std::holds_alternative<MassSpringDamperHandFields>(scenario.hand))
    fail("for maps without a hand that pushes");
  if (device != nullptr && (device->force_max || !device_loop(scenario, 1.0).no_theory.empty()))
    fail("for devices whose loop is linear");
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

/// The value of a scene of the map at a dotted path, or null.
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
        "--set: got {} with --map; allowed: {}, {}, {} and fields of device and hand, such as device.handle_mass_kg",
        path, kTimeStep, kForceStage, kFriction));
  }
  if (path == kWholeDevice) return;  // the axes set their fields afterwards
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

/// The fields of the device that the axes vary, as overrides with the values of this scene of the map.
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
  bool is_of_device = false;
  for (const std::string& override : overrides) {
    if (is_of_rendering(override)) continue;
    if (!is_of_device) require_map_of_device(map);
    is_of_device = true;
    require_field(map, override);
  }
  if (overrides.empty()) return;
  const Scenario scene = with_overrides(map, map.scene(map.x.low, map.y.low, kAnyAlgorithm), overrides);
  if (std::any_of(overrides.begin(), overrides.end(), [](const auto& o) { return is_below(kFriction, o); }))
    require_held(map, scene);
  if (is_of_device && !handle_moves_tool(scene.device))
    throw InputError("--set: got a device of another type with --map; allowed: \"impedance\"");
}

Scenario with_overrides(const StabilityMap& map, Scenario scenario, const std::vector<std::string>& overrides) {
  ScenarioText text{fmt::format("map {}", map.name), effective_scenario(scenario, {})};
  // A search for an edge uses numbers beyond what a file may hold: sections without an override stay out of the text.
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
  scenario.rendering.force_stage = loaded.scenario.rendering.force_stage;
  scenario.rendering.dry_friction = loaded.scenario.rendering.dry_friction;
  if (has_hand) scenario.hand = loaded.scenario.hand;
  return scenario;
}

}  // namespace hapbench
