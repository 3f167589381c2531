#include "scenarios/studies/convergence/level_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/finer_scene.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/studies/stability/field_limit.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// Counts of contacts at the rows that the metrics take in. Other points come with another surface: then it is the
/// number of first touches that tells whether the tool meets the same things.
constexpr const char* kContactCounts[] = {"landings", "steps_in_contact", "colliding_mean", "rendered_mean"};

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

LevelSweep step_levels(const Scenario& scenario, std::size_t levels, double ratio) {
  if (ratio != std::round(ratio)) {
    throw InputError(fmt::format(
        "--ratio: got {}; allowed for {}: whole numbers, so that the rows of all levels coincide", ratio, kStepPath));
  }
  LevelSweep sweep{.axis = {kStepPath}, .formal_order = order_in_step(scenario), .no_order = noise_reason(scenario)};
  int times = 1;
  for (std::size_t i = 0; i < levels; ++i, times *= static_cast<int>(ratio)) {
    std::vector<std::string> overrides = with_finer_step(scenario, times).overrides;
    sweep.axis.values.push_back(overrides.front().substr(std::string_view(kStepPath).size() + 1));
    overrides.erase(overrides.begin());
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

LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio,
                       bool as_it_is) {
  LevelSweep sweep;
  if (path == kStepPath) {
    sweep = step_levels(loaded.scenario, levels, ratio);
  } else {
    sweep.axis = {path};
    double value = coarsest_value(loaded, path);
    for (std::size_t i = 0; i < levels; ++i, value /= ratio)
      sweep.axis.values.emplace_back(std::string_view(NumberText(value)));
    if (as_it_is && own_value(loaded.scenario, path).is_null()) {
      sweep.axis.values.front() = "null";
      sweep.no_order = "the mesh's own points are not as far apart everywhere as those of the other levels";
    }
  }
  sweep.ratio = ratio;
  return sweep;
}

std::optional<double> level_result(const SweepPlan& plan, const SweepRow& row, const std::string& metric) {
  const bool failed = row.outcome == kErrorOutcome || row.outcome == outcome_name(Outcome::diverges);
  return failed ? std::nullopt : row.number(plan, metric);
}

Convergence convergence_of(const LevelSweep& levels, const SweepPlan& plan, std::span<const SweepRow> rows,
                           const std::string& metric) {
  const bool other_points = levels.axis.path.starts_with("environment.");
  const std::span counts = std::span(kContactCounts).first(other_points ? 1 : std::size(kContactCounts));
  std::vector<LevelResult> results;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    LevelResult& level = results.emplace_back();
    level.setting = fmt::format("{} = {}", levels.axis.path, levels.axis.values[i]);
    level.outcome = rows[i].outcome;
    level.result = level_result(plan, rows[i], metric);
    for (const char* name : counts) level.contacts.emplace_back(name, rows[i].number(plan, name).value_or(0.0));
  }
  const auto is_first = [&](const SweepRow& row) { return row.state_hash == rows.front().state_hash; };
  if (rows.size() > 1 && results.back().result && std::ranges::all_of(rows, is_first)) {
    return convergence_of(results, levels.ratio, levels.formal_order,
                          fmt::format("{} has no effect here: all runs are the same, bit for bit", levels.axis.path));
  }
  return convergence_of(results, levels.ratio, levels.formal_order, levels.no_order);
}

}  // namespace hapbench
