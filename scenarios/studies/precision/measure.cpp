#include "scenarios/studies/precision/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

class RowSampler final : public Observer {
 public:
  RowSampler(std::uint64_t stride, std::uint64_t rows) : stride_(stride) {
    run.positions.reserve(rows / stride + 1);
    run.forces.reserve(rows / stride + 1);
  }
  void on_step(const StepRecord& record) noexcept override {
    run.in_contact = run.in_contact || record.colliding > 0;
    if (record.step % stride_ != 0) return;
    run.positions.push_back(record.tool.pose.position);
    run.forces.push_back(record.force.rendered);
  }
  SampledRun run;

 private:
  std::uint64_t stride_;
};

/// Keeps copies of the contacts a law saw.
class ContactSampler final : public Observer {
 public:
  ContactSampler(std::uint64_t stride, std::vector<ContactBuffer>& sets) : stride_(stride), sets_(&sets) {}
  void on_step(const StepRecord& record) noexcept override {
    const ContactBuffer& seen = *record.rendered;
    if (record.step % stride_ != 0 || seen.empty()) return;
    sets_->emplace_back(seen.size()).assign(seen);
  }

 private:
  std::uint64_t stride_;
  std::vector<ContactBuffer>* sets_;
};

constexpr double kPeriod = 6.0;  // of the tilt of task 2 [s]

}  // namespace

SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers) {
  const SimulationConfig config = simulation_config(scenario);
  RowSampler sampler(stride, config.steps);
  observers.push_back(&sampler);
  Simulation simulation(config, assemble(scenario, std::move(shell), {}), std::move(observers));
  sampler.run.result = run_to_end(simulation);
  return std::move(sampler.run);
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

double fitted_order(std::span<const double> x, std::span<const double> error) {
  std::vector<double> log_x, log_error;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(error[i] > 0.0) || !std::isfinite(error[i])) continue;
    log_x.push_back(std::log(x[i]));
    log_error.push_back(std::log(error[i]));
  }
  return slope(log_x, log_error);
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

IdealDeviceFields with_ideal_device(const DeviceFields& device) {
  return {input_force_limit(device)};
}

Scenario drill_in_hole(Scenario scenario) {
  if (!std::holds_alternative<BlockEnvironment>(scenario.environment)) {
    throw InputError(
        InputError::Kind::relation, "/environment/type",
        "got another environment; allowed for this study: block_with_hole, the hole its drill is measured in "
        "(the study time_step takes any scene)");
  }
  make_cylinder(scenario.tool);  // refuses any other
  if (!has_ideal_trajectory(scenario)) {
    throw InputError(InputError::Kind::relation, "/tool/tip",
                     "got \"round\"; allowed for this study: \"flat\", whose ideal trajectory is known");
  }
  scenario.device = with_ideal_device(scenario.device);
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

std::vector<ContactBuffer> rendered_contact_sets(const Scenario& scenario, std::uint64_t stride) {
  std::vector<ContactBuffer> sets;
  ContactSampler sampler(stride, sets);
  Simulation simulation(simulation_config(scenario), assemble(scenario, make_shell(scenario), {}), {&sampler});
  run_to_end(simulation);
  return sets;
}

}  // namespace hapbench
