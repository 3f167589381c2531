#include "scenarios/studies/precision/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr double kPeriod = 6.0;  // [s], of the tilt of task 2

}  // namespace

Scenario with_step(const Scenario& scenario, double factor) {
  Scenario run = scenario;
  run.time.step = scenario.time.step * factor;
  run.time.steps = std::llround(static_cast<double>(scenario.time.steps) / factor);
  return run;
}

void require_free_position(const Scenario& scenario) {
  if (std::holds_alternative<FreePosition>(scenario.motion.position)) return;
  throw InputError(InputError::Kind::relation, "/motion/position/type",
                   "got a prescribed position; allowed for this study: \"free\"");
}

SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers) {
  const SimulationConfig config = simulation_config(scenario);
  SampledRun run;
  run.positions.reserve(config.steps / stride + 1);
  run.forces.reserve(config.steps / stride + 1);
  OnEachRow sampler([&](const StepRecord& record) {
    run.in_contact = run.in_contact || record.colliding > 0;
    if (record.step % stride != 0) return;
    run.positions.push_back(record.tool.pose.position);
    run.forces.push_back(record.force.rendered);
  });
  observers.push_back(&sampler);
  Simulation simulation(config, assemble(scenario, std::move(shell), {}), std::move(observers));
  run.result = run_to_end(simulation);
  return run;
}

TrajectoryDistance distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  TrajectoryDistance d;
  const std::size_t samples = std::min(a.size(), b.size());
  if (samples == 0) return d;
  for (std::size_t i = 0; i < samples; ++i) {
    d.final = (a[i] - b[i]).norm();
    d.rms += d.final * d.final / static_cast<double>(samples);
    d.max = std::max(d.max, d.final);
  }
  d.rms = std::sqrt(d.rms);
  return d;
}

double slope(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sx += x[i];
    sy += y[i];
    sxx += x[i] * x[i];
    sxy += x[i] * y[i];
  }
  const double spread = n * sxx - sx * sx;
  return n >= 2.0 && spread > 0.0 ? (n * sxy - sx * sy) / spread : std::numeric_limits<double>::quiet_NaN();
}

Order observed_order(std::span<const double> x, std::span<const double> error) {
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (error[i] > 0.0 && std::isfinite(error[i])) valid.push_back(i);
  // Between the `back`-th valid error from the end and the next finer one.
  const auto order = [&](std::size_t back) {
    if (valid.size() < back) return std::numeric_limits<double>::quiet_NaN();
    const std::size_t coarse = valid[valid.size() - back], fine = valid[valid.size() - back + 1];
    return math::log(error[coarse] / error[fine]) / math::log(x[coarse] / x[fine]);
  };
  return {order(2), std::abs(order(2) - order(3))};
}

double seconds_per_step(const Scenario& scenario, std::shared_ptr<const PointShell> shell, int repetitions) {
  Simulation simulation(simulation_config(scenario), assemble(scenario, std::move(shell), {}), {});
  const SimulationResult warm_up = run_to_end(simulation);
  if (warm_up.rows == 0) return 0.0;
  return seconds_per_call(warm_up.rows, repetitions, [&simulation] {
    simulation.reset();
    run_to_end(simulation);
  });
}

Scenario drill_in_hole(Scenario scenario) {
  if (!std::holds_alternative<BlockEnvironment>(scenario.environment)) {
    throw InputError(
        InputError::Kind::relation, "/environment/type",
        "got another environment; allowed for this study: block_with_hole, the hole its drill is measured in "
        "(the study time_step takes any scene)");
  }
  make_cylinder(scenario.tool);  // refuses other tools
  if (!has_ideal_trajectory(scenario)) {
    throw InputError(InputError::Kind::relation, "/tool/tip",
                     "got \"round\"; allowed for this study: \"flat\", whose ideal trajectory is known");
  }
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  const auto rows = static_cast<std::int64_t>(std::llround(kPeriod / scenario.time.step));
  scenario.time.steps = std::min(scenario.time.steps, rows);
  scenario.record = {};
  return scenario;
}

std::vector<ContactBuffer> contact_sets(Scenario scenario, std::uint64_t stride) {
  scenario.rendering.reduction.reset();
  scenario.rendering.local_average = false;
  return rendered_contact_sets(scenario, stride);
}

std::vector<ContactBuffer> drill_contact_sets(const Scenario& scenario) {
  std::vector<ContactBuffer> sets = contact_sets(drill_in_hole(scenario), kContactSetStride);
  if (sets.empty()) throw InputError("the tool of this scenario touches nothing; the study needs contacts");
  return sets;
}

std::vector<ContactBuffer> rendered_contact_sets(const Scenario& scenario, std::uint64_t stride) {
  std::vector<ContactBuffer> sets;
  OnEachRow sampler([&](const StepRecord& record) {
    const ContactBuffer& seen = *record.rendered;
    if (record.step % stride == 0 && !seen.empty()) sets.emplace_back(seen.size()).assign(seen);
  });
  Simulation simulation(simulation_config(scenario), assemble(scenario, make_shell(scenario), {}), {&sampler});
  run_to_end(simulation);
  return sets;
}

std::size_t largest_size(const std::vector<ContactBuffer>& sets) {
  std::size_t largest = 0;
  for (const ContactBuffer& set : sets) largest = std::max(largest, set.size());
  return largest;
}

const std::vector<std::string> kIdealColumns = {"ideal_height_error_rms_m", "ideal_height_error_max_m",
                                                "ideal_lateral_error_rms_m", "interpenetration_max_m",
                                                "force_step_max_N"};

IdealRun ideal_run(std::string setting, const Scenario& scenario, std::shared_ptr<const PointShell> shell,
                   int repetitions) {
  const BlockWithHole& block = std::get<BlockEnvironment>(scenario.environment).block;
  IdealTrajectoryObserver ideal(block, make_cylinder(scenario.tool));
  MetricsObserver motion(scenario.time.step);
  SampledRun run = sampled_run(scenario, shell, kContactSetStride, {&ideal, &motion});
  const IdealTrajectoryMetrics metrics = ideal.metrics();
  const TrajectoryErrors& errors = metrics.gentle.rows > 0 ? metrics.gentle : metrics.firm;
  const double highest = std::max(-errors.height_min, errors.height_max);
  return {
      {std::move(setting),
       std::string(outcome_name(run.result.outcome)),
       {errors.height_rms, highest, errors.lateral_rms, errors.interpenetration_max, motion.metrics().force_step_max},
       seconds_per_step(scenario, std::move(shell), repetitions)},
      std::move(run.positions)};
}

}  // namespace hapbench
