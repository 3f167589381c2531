#include "scenarios/studies/convergence/level_sweep.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "scenarios/studies/stability/field_limit.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// Of the step. A device samples: between its samples the force is held, which is of the first order.
double order_in_step(const Scenario& scenario) {
  const IntegratorEntry& integrator = *scenario.integrator.type;
  if (!std::holds_alternative<IdealDeviceFields>(scenario.device)) return 1.0;
  const RenderingConfig& r = scenario.rendering;
  return normal_damping(r) > 0.0 || r.has_friction() ? integrator.damped_order : integrator.order;
}

std::string noise_reason(const Scenario& scenario) {
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  const char* source = std::holds_alternative<TrackingHandFields>(scenario.hand) ? "hand"
                       : admittance != nullptr && admittance->sensor.noise > 0.0 ? "force sensor"
                                                                                 : nullptr;
  return source == nullptr ? "" : fmt::format("the noise of the {} is drawn anew in every step", source);
}

/// Delays of devices keep their length.
std::vector<std::string> kept_delays(const Scenario& scenario, std::int64_t times) {
  std::vector<std::string> overrides;
  const auto keep = [&overrides, times](const char* field, auto steps) {
    if (steps > 0) overrides.push_back(fmt::format("{}={}", field, static_cast<decltype(steps)>(times) * steps));
  };
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device))
    keep("device.delay_samples", device->delay_samples);
  if (const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device))
    keep("device.servo.delay_samples", device->servo.delay);
  return overrides;
}

LevelSweep step_levels(const Scenario& scenario, std::size_t levels, double ratio) {
  if (ratio != std::round(ratio)) {
    throw InputError(fmt::format(
        "--ratio: got {}; allowed for {}: whole numbers, so that the rows of all levels coincide", ratio, kStepPath));
  }
  LevelSweep sweep{.axis = {kStepPath}, .formal_order = order_in_step(scenario), .no_order = noise_reason(scenario)};
  std::int64_t times = 1;
  for (std::size_t i = 0; i < levels; ++i, times *= static_cast<std::int64_t>(ratio)) {
    std::vector<std::string> overrides = kept_delays(scenario, times);
    overrides.insert(overrides.begin(), fmt::format("time.steps={}", times * scenario.time.steps));
    sweep.axis.values.push_back(fmt::format("{}", scenario.time.step / static_cast<double>(times)));
    sweep.axis.along.push_back({std::move(overrides), times});
  }
  return sweep;
}

/// The field's value in the scenario.
double coarsest_value(const LoadedScenario& loaded, const std::string& path) {
  const Json own = own_value(loaded.scenario, path);
  if (own.is_number_float() && own.get<double>() > 0.0) return own.get<double>();
  if (own.is_null()) {
    const auto distance = point_distance(loaded);
    if (distance && path == distance->path) return distance->metres;
  }
  throw InputError(
      fmt::format("--vary: got {}, which is {} in the scenario; allowed: a field that is a number > 0 and no "
                  "integer, such as {}, environment.grid_m, environment.spacing_m or tool.grid_m",
                  path, own.is_null() ? "not given" : own.dump(), kStepPath));
}

}  // namespace

LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio) {
  LevelSweep sweep;
  if (path == kStepPath) {
    sweep = step_levels(loaded.scenario, levels, ratio);
  } else {
    sweep.axis = {path};
    double value = coarsest_value(loaded, path);
    for (std::size_t i = 0; i < levels; ++i, value /= ratio)
      sweep.axis.values.emplace_back(std::string_view(NumberText(value)));
  }
  sweep.ratio = ratio;
  return sweep;
}

}  // namespace hapbench
