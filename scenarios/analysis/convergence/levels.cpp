#include "scenarios/analysis/convergence/levels.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/io/columns.hpp"
#include "scenarios/analysis/current_value.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// Returns the formal order of convergence in the time step. With a device, the order is 1, because the device holds
/// the force between samples. Without device and damping, the order of leapfrog is 2, which is its order for amplitudes
/// and energies. Positions and velocities of leapfrog at a fixed time have order 1: its velocity belongs to a time half
/// a step earlier than its position, but the run starts with both at time 0.
double order_in_step(const Scenario& scenario) {
  const IntegratorEntry& integrator = *scenario.integrator.type;
  if (has_device(scenario)) return 1.0;
  const RenderingConfig& r = scenario.rendering;
  const bool damped = normal_damping(r) > 0.0 || r.hunt_crossley || r.has_friction();
  if (damped) return integrator.damped_order;
  return &integrator == &kLeapfrog ? 2.0 : integrator.order;
}

/// Returns a text that explains which noise prevents convergence in the time step; empty without noise.
std::string noise_reason(const Scenario& scenario) {
  const auto drawn = [](const char* noise) {
    return fmt::format("{} is drawn anew at every step, so that a finer step is another signal", noise);
  };
  if (const auto* tracking = std::get_if<TrackingHandFields>(&scenario.hand);
      tracking != nullptr && std::ranges::any_of(tracking->subjects, [tracking](const Subject& subject) {
        const bool tilts = tracking->task.display == TargetDisplay::height;
        return subject.motor_noise > 0.0 || (tilts && subject.tilt_noise > 0.0);
      }))
    return drawn("the noise of the hand (motor_noise_N and tilt_noise_rad in hand.subjects)");
  if (const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
      device != nullptr && device->sensor.noise > 0.0)
    return drawn("the noise of the force sensor (device.sensor.noise_N)");
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
      device != nullptr && device->position_noise > 0.0)
    return drawn("the noise of the measured position (device.position_noise_m)");
  return "";
}

/// Returns the overrides that keep times constant that the scenario counts in time steps, if the time step becomes
/// `times` smaller: the delay of the device, and the period and the delay of multi-rate contacts.
std::vector<std::string> with_constant_times(const Scenario& scenario, std::int64_t times) {
  std::vector<std::string> overrides;
  if (const double delay = delay_of(scenario); delay > 0.0)
    overrides.push_back(fmt::format("{}={}", delay_path(scenario), static_cast<double>(times) * delay));
  if (has_multi_rate_contacts(scenario)) {
    const MultiRateSchedule& contacts = *scenario.rendering.multi_rate;
    overrides.push_back(fmt::format("{}={}", parameter::kEvery.field, times * contacts.every));
    overrides.push_back(fmt::format("{}={}", parameter::kDelay.field, times * contacts.delay));
  }
  return overrides;
}

/// Returns the levels of the time step. Throws InputError if the ratio is not an integer.
LevelSweep step_levels(const Scenario& scenario, std::size_t levels, double ratio) {
  if (ratio != std::round(ratio))
    fail_in_option("--ratio",
                   fmt::format("got {}; allowed for {}: whole numbers, so that the rows of all levels coincide", ratio,
                               kStepPath));
  LevelSweep sweep{{kStepPath}, ratio, order_in_step(scenario), noise_reason(scenario)};
  sweep.has_noise = !sweep.no_order.empty();
  std::int64_t times = 1;
  for (std::size_t i = 0; i < levels; ++i, times *= static_cast<std::int64_t>(ratio)) {
    std::vector<std::string> overrides = {fmt::format("time.steps={}", times * scenario.time.steps)};
    const std::vector<std::string> constant = with_constant_times(scenario, times);
    overrides.insert(overrides.end(), constant.begin(), constant.end());
    sweep.axis.values.push_back(fmt::format("{}", scenario.time.step / static_cast<double>(times)));
    sweep.axis.along.push_back({std::move(overrides), times});
  }
  return sweep;
}

/// Returns the value of the first level: the scenario's value, or, for a spacing that is not given, the mean distance
/// between neighbouring vertices. Throws InputError if there is neither a value above 0 nor such a mean distance.
double coarsest_value(const LoadedScenario& loaded, const std::string& path) {
  const Json own = current_value(loaded.scenario, path);
  if (own.is_number_float() && own.get<double>() > 0.0) return own.get<double>();
  if (own.is_null()) {
    const auto distance = point_distance(loaded);
    if (distance && path == distance->path) return distance->metres;
  }
  fail_in_option("--vary",
                 fmt::format("got {}, which is {} in the scenario; allowed: a field that is a number > 0 and no "
                             "integer, such as {}, environment.grid_m, environment.spacing_m or tool.grid_m",
                             path, own.is_null() ? "not given" : own.dump(), kStepPath));
}

}  // namespace

LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio) {
  if (path == kStepPath) return step_levels(loaded.scenario, levels, ratio);
  LevelSweep sweep{{path}, ratio};
  double value = coarsest_value(loaded, path);
  for (std::size_t i = 0; i < levels; ++i, value /= ratio)
    sweep.axis.values.emplace_back(std::string_view(NumberText(value)));
  return sweep;
}

std::string level_text(const LevelSweep& levels, std::size_t i) {
  const std::string& value = levels.axis.values[i];
  const auto number = finite_number(value);
  return number ? fmt::format("{:.6g}", *number) : value;
}

Cases finer_cases(const LevelSweep& levels, const Cases& cases) {
  // Drop the first level, which is the original case.
  Axis axis = levels.axis;
  axis.values.erase(axis.values.begin());
  if (!axis.along.empty()) axis.along.erase(axis.along.begin());
  std::vector<Axis> axes = cases.axes();
  axes.insert(axes.begin(), axis);
  Cases finer(cases.scenes(), cases.sets(), std::move(axes));
  // Validate one case of each level.
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    try {
      checked(finer.load(i * cases.size()));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{} = {}: {}", axis.path, axis.values[i], error.problem()));
    }
  }
  return finer;
}

}  // namespace hapbench
