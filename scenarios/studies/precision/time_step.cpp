#include <fmt/format.h>

#include <cmath>

#include "results/observe/ideal_trajectory.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// The time steps of the study, in units of the scenario's own.
constexpr double kFactors[] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.125};
/// The reference is so many times finer than the scenario's own step: 16 times finer than the finest row, whose error
/// is so underestimated by 1/16 at first order and by less at higher ones.
constexpr int kReference = 128;

/// All runs are compared at the samples of the coarsest one.
std::uint64_t stride(double factor) {
  return static_cast<std::uint64_t>(std::llround(kFactors[0] / factor));
}

bool moves_freely(const Scenario& scenario) {
  return std::holds_alternative<FreePosition>(scenario.motion.position);
}

bool has_ideal(const Scenario& scenario) {
  return has_ideal_trajectory(scenario) && moves_freely(scenario);
}

void refuse_noise(const Scenario& scenario) {
  if (!std::holds_alternative<TrackingHandFields>(scenario.hand)) return;
  throw InputError(InputError::Kind::relation, "/hand/type",
                   "got \"tracking\", whose noise is drawn anew in every step; allowed for this study: other hands");
}

/// Any other scene, as long as a multiple of the coarsest step, without a device of its own.
Scenario any_scene(Scenario scenario) {
  if (scenario.time.steps < 2 * std::llround(kFactors[0])) {
    throw InputError(
        InputError::Kind::relation, "/time/steps",
        fmt::format("got {}; allowed for this study: at least {}", scenario.time.steps, 2 * std::llround(kFactors[0])));
  }
  scenario.time.steps -= scenario.time.steps % std::llround(kFactors[0]);  // so that all end at the same time
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  scenario.record = {};
  return scenario;
}

/// The run that the others are measured against.
SampledRun reference_run(const Scenario& scenario, const std::shared_ptr<const PointShell>& shell) {
  SampledRun run = sampled_run(with_step(scenario, 1.0 / kReference), shell, stride(1.0 / kReference));
  if (run.result.outcome == Outcome::diverges) {
    throw InputError(
        InputError::Kind::relation, "/time/step_s",
        fmt::format("even with a step {} times finer the run diverges, at {:.4g} s: nothing to compare with",
                    kReference, run.result.divergence.time));
  }
  if (!run.in_contact) throw InputError("the tool of this scenario touches nothing; the study needs contacts");
  return run;
}

PrecisionRow row_of(const Scenario& run, const SampledRun& sampled, const TrajectoryDistance& error, double seconds) {
  return {fmt::format("dt={}", run.time.step),
          std::string(outcome_name(sampled.result.outcome)),
          {run.time.step, error.final, error.rms, error.max},
          seconds};
}

}  // namespace

static PrecisionResult study_time_step(const Scenario& given, const PrecisionOptions& options) {
  refuse_noise(given);
  const bool ideal = has_ideal(given), free = moves_freely(given);
  const Scenario scenario = ideal ? drill_in_hole(given) : any_scene(given);
  const double half_width = make_tool(scenario)->half_width();
  const auto shell = make_shell(scenario);
  const SampledRun reference = reference_run(scenario, shell);

  PrecisionResult result;
  const std::string unit = free ? "m" : "N";
  result.columns = {"step_s", "error_final_" + unit, "error_rms_" + unit, "error_max_" + unit};
  if (ideal) result.columns.emplace_back("ideal_height_error_rms_m");
  result.timed = "step";
  // Differences between each run and the next finer one do not depend on the reference.
  std::vector<double> steps, differences;
  std::vector<Vec3> coarser;
  for (const double factor : kFactors) {
    const Scenario run = with_step(scenario, factor);
    std::optional<IdealTrajectoryObserver> beside;
    if (ideal) beside.emplace(std::get<BlockEnvironment>(scenario.environment).block, make_cylinder(scenario.tool));
    const SampledRun sampled =
        sampled_run(run, shell, stride(factor), beside ? std::vector<Observer*>{&*beside} : std::vector<Observer*>());
    const TrajectoryDistance d =
        free ? distance(sampled.positions, reference.positions) : distance(sampled.forces, reference.forces);
    PrecisionRow row = row_of(run, sampled, d, seconds_per_step(run, shell, options.repetitions));
    if (beside) row.values.emplace_back(beside->metrics().gentle.height_rms);
    result.add(std::move(row), options, std::size(kFactors));
    // A drill that was thrown out may be anywhere: its distance from the reference does not converge.
    const bool thrown_out = free && !(d.max <= half_width);
    if (sampled.positions.size() != reference.positions.size() || thrown_out) continue;
    const std::vector<Vec3>& series = free ? sampled.positions : sampled.forces;
    if (!coarser.empty()) {
      steps.push_back(run.time.step);
      differences.push_back(distance(coarser, series).rms);
    }
    coarser = series;
  }
  result.orders.push_back(
      {std::string(scenario.integrator.type->info.name), "error_rms_" + unit, observed_order(steps, differences)});
  // The reference's own error over the row's; at first order where none is seen.
  const double order = result.orders.front().order.value;
  for (std::size_t i = 0; i < result.rows.size(); ++i)
    result.rows[i].tolerance = math::pow(kReference * kFactors[i], order > 0.0 ? -order : -1.0);
  return result;
}

const PrecisionStudy kTimeStepStudy = {
    "time_step", "any scene against itself at a 128 times finer step: position if free, else force", "rotate_in_hole",
    study_time_step};

}  // namespace hapbench
