#include "scenarios/renderer/open_renderer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "scenarios/input/input_error.hpp"
#include "scenarios/renderer/loop_log.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

constexpr double kMaxRamp = 60.0;  ///< largest ramp_s that a mount may have [s]

/// A field of a scenario's device that the renderer uses, and the mode in which the renderer uses it. These fields
/// describe filters and limits that run as software in a real system.
struct UsedField {
  const char* name;
  std::uint32_t mode;
};
constexpr UsedField kUsedFields[] = {{"velocity_filter", HAPBENCH_IMPEDANCE},
                                     {"position_filter", HAPBENCH_IMPEDANCE},
                                     {"force_max_N", HAPBENCH_IMPEDANCE},
                                     {"force_slew_N_per_s", HAPBENCH_IMPEDANCE},
                                     {"force_limit_N", HAPBENCH_ADMITTANCE}};

void require(bool holds, const char* field, double got, const char* allowed) {
  if (!holds) throw InputError(fmt::format("mount.{}: got {}; allowed: {}", field, got, allowed));
}

void check_pose(const HapbenchPose3& pose, const char* field) {
  double squares = 0.0;
  for (const double number : pose.orientation) squares += number * number;
  const bool finite = std::ranges::all_of(pose.position, [](double number) { return std::isfinite(number); });
  if (!finite) throw InputError(fmt::format("mount.{}.position: got a number that is not finite", field));
  if (!(std::abs(std::sqrt(squares) - 1.0) <= 1e-3))
    throw InputError(fmt::format("mount.{}.orientation: got a quaternion of norm {}; allowed: a norm of 1", field,
                                 std::sqrt(squares)));
}

}  // namespace

void check_mount(const RendererSetup& setup) {
  const HapbenchMount& mount = setup.mount;
  check_pose(mount.world_from_device, "world_from_device");
  check_pose(mount.handle_from_tip, "handle_from_tip");
  require(mount.scale > 0.0 && std::isfinite(mount.scale), "scale", mount.scale, "a number > 0");
  if (setup.mode == HAPBENCH_IMPEDANCE) {
    require(mount.max_force > 0.0, "max_force", mount.max_force,
            "the largest force that device and hand bear, > 0 [N]; INFINITY: no limit");
    require(mount.max_force_rate > 0.0, "max_force_rate", mount.max_force_rate, "> 0 [N/s]; INFINITY: no limit");
  }
  require(mount.ramp_s >= 0.0 && mount.ramp_s <= kMaxRamp, "ramp_s", mount.ramp_s, "0 to 60 s");
  require(mount.stale_s > 0.0, "stale_s", mount.stale_s, "> 0 [s]; INFINITY: no limit");
  require(mount.engage_force > 0.0, "engage_force", mount.engage_force, "> 0 [N]");
}

void check_period(const Scenario& scenario, const RendererSetup& setup) {
  const double period = scenario.time.step, stale = setup.mount.stale_s;
  if (period < stale) return;
  constexpr double kUsualPeriods = 10.0;  // with a period of 1 ms, these are the default of stale_s
  throw InputError(fmt::format(
      "mount.stale_s: got {0} s, but the period of the loop (time.step_s) is {1} s: calls would be late, and the force "
      "would stay 0; allowed: > {1} s, such as {2:.4g} s, or a time.step_s < {0} s, if that is the period of your loop",
      stale, period, kUsualPeriods * period));
}

namespace {

/// Throws InputError if the scenario cannot be rendered.
void check_scenario(const Scenario& scenario, const RendererSetup& setup) {
  if (scenario.rendering.contact_source == kTrace)
    fail_at("/rendering/contact_source",
            "got a recorded trace, whose contacts belong to the poses of its own run; "
            "allowed for a renderer: \"own\" or a module");
  if (setup.mode == HAPBENCH_ADMITTANCE && handle_moves_tool(scenario.device))
    fail_at("/device/type",
            "got \"impedance\", whose handle moves the tool without a virtual mass; allowed in "
            "admittance mode: \"ideal\" or \"admittance\"");
  if (setup.mode == HAPBENCH_ADMITTANCE && !(scenario.rendering.mass > 0.0))
    fail_at("/rendering/mass_kg", "got 0; allowed in admittance mode: the virtual mass, > 0");
}

LiveRendererConfig live_config(const Scenario& scenario, const RendererSetup& setup) {
  LiveRendererConfig config;
  config.is_admittance = setup.mode == HAPBENCH_ADMITTANCE;
  config.wants_torque = (setup.flags & HAPBENCH_TORQUE) != 0;
  config.mount = setup.mount;
  config.input_force_limit = input_force_limit(scenario.device);
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    config.velocity_filter = device->velocity_filter;
    config.position_filter = device->position_filter;
    const double none = std::numeric_limits<double>::infinity();
    config.mount.max_force = std::min(config.mount.max_force, device->force_max.value_or(none));
    config.mount.max_force_rate = std::min(config.mount.max_force_rate, device->force_slew.value_or(none));
  }
  return config;
}

/// If `used` is true, returns the fields of the scenario's device that the renderer uses. Otherwise returns the fields
/// of the device that the renderer ignores.
std::string device_fields(const Json& device, std::uint32_t mode, bool used) {
  std::string text;
  for (const auto& [name, value] : device.items()) {
    const bool is_used = std::ranges::any_of(
        kUsedFields, [&, &key = name](const UsedField& field) { return key == field.name && mode == field.mode; });
    if (name == "type" || value.is_null() || is_used != used) continue;
    text += fmt::format("{}device.{}{}", text.empty() ? "" : ", ", name, used ? " = " + value.dump() : "");
  }
  return text.empty() ? "none" : text;
}

std::string inspection(const CheckedScenario& checked, const RendererSetup& setup, const Json& effective) {
  const Scenario& scenario = checked.scenario();
  const bool is_impedance = setup.mode == HAPBENCH_IMPEDANCE;
  const LiveRendererConfig config = live_config(scenario, setup);
  std::string text = fmt::format("scenario: {} ({})\n", scenario.name, checked.loaded().file.string());
  text += fmt::format("algorithm: {}, K = {} N/m\n", scenario.rendering.algorithm, scenario.rendering.stiffness);
  text += fmt::format("mode: {}\nperiod: {} s (time.step_s)\n", mode_name(setup.mode), scenario.time.step);
  text += fmt::format("used of the device: {}\n", device_fields(effective.at("device"), setup.mode, true));
  text += fmt::format("ignored, because the real device has its own: {}\n",
                      device_fields(effective.at("device"), setup.mode, false));
  text +=
      fmt::format("ignored, because your hand moves the tool: hand, motion, initial, time.steps, time.stop_when{}\n",
                  is_impedance ? ", integrator" : "");
  text += "ignored, because nothing is recorded: record, metrics, expect, reference_force\n";
  if (is_impedance) {
    text += fmt::format("velocity: {}\n", config.velocity_filter
                                              ? "the caller's, or by device.velocity_filter"
                                              : "the caller's in every call (the scenario has no velocity filter)");
    text +=
        fmt::format("largest force: {} N, largest rate: {} N/s\n", config.mount.max_force, config.mount.max_force_rate);
  } else {
    text += fmt::format("virtual mass: {} kg, integrator {}\n", scenario.rendering.mass,
                        scenario.integrator.type->info.name);
    text += "ignored in admittance mode: mount.max_force, mount.max_force_rate\n";
  }
  if (has_multi_rate_contacts(scenario))
    text += "used: rendering.contacts, so contacts are delayed or lost as in the simulation\n";
  if (std::holds_alternative<Hole2d>(scenario.environment))
    text += "note: the scene is planar; it has contacts near z = 0 only\n";
  return text;
}

}  // namespace

const char* mode_name(std::uint32_t mode) {
  return mode == HAPBENCH_ADMITTANCE ? "admittance" : "impedance";
}

HapbenchRenderer* new_renderer(const CheckedScenario& checked, const RendererSetup& setup) {
  const Scenario& scenario = checked.scenario();
  check_scenario(scenario, setup);
  const Json effective = effective_scenario(scenario, std::filesystem::current_path());
  SimulationParts parts = assemble_rendering(scenario, checked.files(), make_shell(scenario, checked.files()));
  return new HapbenchRenderer{
      LiveRenderer(live_config(scenario, setup), simulation_config(scenario), std::move(parts)),
      inspection(checked, setup, effective),
      log_header(setup, {scenario.name, scenario_hash(effective, checked.files()), scenario.time.step})};
}

}  // namespace hapbench
