#include <fmt/format.h>

#include <cmath>

#include "results/observe/ideal_trajectory.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/studies/precision/study.hpp"

namespace hapbench {
namespace {

/// The time steps of the study, in units of the scenario's own.
constexpr double kFactors[] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625};
constexpr int kReference = 64;  // times finer than the scenario's own step

Scenario with_step(const Scenario& scenario, double factor) {
  Scenario run = scenario;
  run.time.step = scenario.time.step * factor;
  run.time.steps = std::llround(static_cast<double>(scenario.time.steps) / factor);
  return run;
}

}  // namespace

static PrecisionResult study_time_step(const Scenario& given, const PrecisionOptions& options) {
  const Scenario scenario = drill_in_hole(given);
  const BlockWithHole& block = std::get<BlockEnvironment>(scenario.environment).block;
  const Cylinder tool = make_cylinder(scenario.tool);
  const auto shell = shell_of(scenario, options);
  // All are compared at the samples of the coarsest one.
  const double sampling = kFactors[0];
  const auto stride = [sampling](double factor) { return static_cast<std::uint64_t>(std::llround(sampling / factor)); };
  const SampledRun reference = sampled_run(with_step(scenario, 1.0 / kReference), shell, stride(1.0 / kReference));

  PrecisionResult result;
  result.columns = {"step_s", "error_final_m", "error_rms_m", "error_max_m", "ideal_height_error_rms_m"};
  result.timed = "step";
  std::vector<double> steps, errors;
  for (const double factor : kFactors) {
    const Scenario run = with_step(scenario, factor);
    IdealTrajectoryObserver ideal(block, tool);
    const SampledRun sampled = sampled_run(run, shell, stride(factor), {&ideal});
    const TrajectoryDistance d = distance(sampled.positions, reference.positions);
    result.rows.push_back({fmt::format("dt={}", run.time.step),
                           std::string(outcome_name(sampled.result.outcome)),
                           {run.time.step, d.final, d.rms, d.max, ideal.metrics().gentle.height_rms},
                           seconds_per_step(run, shell, options.repetitions)});
    // A drill that was thrown out may be anywhere: its distance from the reference does not converge.
    if (sampled.positions.size() != reference.positions.size() || !(d.max <= tool.half_width())) {
      options.progress(result.rows.size(), std::size(kFactors));
      continue;
    }
    steps.push_back(run.time.step);
    errors.push_back(d.rms);
    options.progress(result.rows.size(), std::size(kFactors));
  }
  result.orders.push_back({fmt::format("{} with contact switching", scenario.integrator.type->info.name), "error_rms_m",
                           fitted_order(steps, errors)});
  return result;
}

const PrecisionStudy kTimeStepStudy = {
    "time_step", "a drill turned in a hole against a time step 64 times finer, over the time step",
    "rotate_in_hole", study_time_step};

}  // namespace hapbench
