#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/run/assemble.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/bench/accuracy/accuracy.hpp"

/// Panels of a free tool whose contacts are found too late: in some rows only, or anywhere between two rows.
namespace hapbench::accuracy {
namespace {

constexpr std::int64_t kQueryEvery[] = {1, 2, 4, 8, 16, 32};
/// [s]; later two ways are apart because the scene is chaotic, whatever parted them.
constexpr double kTogether = 0.2;

/// Steps of the bounce, in steps of the scene.
constexpr double kStepFactors[] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.125};

Scenario briefly_free(Scenario scenario) {
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  scenario.time.steps = std::min<std::int64_t>(scenario.time.steps, std::llround(kTogether / scenario.time.step));
  scenario.record = {};
  return scenario;
}

Errors off_the_fresh(const Scenario& run, const std::shared_ptr<const PointShell>& shell,
                     const std::vector<Vec3>& fresh) {
  MetricsObserver metrics(run.time.step, {});
  const SampledRun late = sampled_run(run, shell, 1, {&metrics});
  const double every = run.rendering.late ? static_cast<double>(run.rendering.late->every) : 1.0;
  return {std::string(outcome_name(late.result.outcome)),
          {{"rate_Hz", 1.0 / (run.time.step * every)},
           {"error_rms_m", distance(late.positions, fresh).rms},
           {"force_rms_above_30Hz_N", told(metrics, "force_rms_above_30Hz_N")}}};
}

/// M v^2 / 2 and what the springs store, at the first and the last row [J], and how often contact began or ended.
class MechanicalEnergy final : public Observer {
 public:
  explicit MechanicalEnergy(double mass) : mass_(mass) {}
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override {
    last_ = 0.5 * mass_ * record.tool.velocity.squaredNorm() + record.springs.energy;
    if (record.step == 0) first_ = last_;
    const bool touches = record.colliding > 0;
    switches_ += record.step > 0 && touches != touched_ ? 1 : 0;
    touched_ = touches;
  }
  double first() const { return first_; }
  double created() const { return last_ - first_; }
  double switches() const { return switches_; }

 private:
  double mass_, first_ = 0.0, last_ = 0.0, switches_ = 0.0;
  bool touched_ = false;
};

/// A free tool without hand, damping and friction keeps its energy, unless law or sampling change it.
Scenario bouncing(Scenario scenario) {
  scenario.hand = NoHandFields{};
  scenario.device = IdealDeviceFields{};
  RenderingConfig& r = scenario.rendering;
  r.damping = 0.0;
  r.mu_s = r.mu_f = 0.0;
  r.dry_friction.reset();
  r.hunt_crossley.reset();
  r.passivity_controller = false;
  scenario.record = {};
  return scenario;
}

Scenario with(const Scenario& scenario, const IntegratorEntry& integrator, double factor) {
  Scenario run = with_step(scenario, factor);
  run.integrator.type = &integrator;
  return run;
}

}  // namespace

Panel late_contacts(const Scenario& free) {
  const Scenario scenario = briefly_free(free);
  const auto shell = once([scenario] { return make_shell(scenario); });
  Panel panel;
  for (const AlgorithmEntry& algorithm : hapbench::algorithms()) {
    Scenario run = with_algorithm(scenario, algorithm.info->name);
    run.rendering.late.reset();
    const auto fresh = once([=] { return sampled_run(run, shell(), 1).positions; });
    for (const bool linear : {false, true}) {
      for (const std::int64_t every : kQueryEvery) {
        run.rendering.late = Lateness{};
        run.rendering.late->every = every;
        run.rendering.late->linear = linear;
        panel.push_back({fmt::format("late_contacts/{} {} {}", algorithm.info->name, linear ? "linear" : "hold", every),
                         "step", [=] { return off_the_fresh(run, shell(), fresh()); },
                         [=] { return bare_run(run, shell()); }});
      }
    }
  }
  return panel;
}

Panel skips(const Scenario& free) {
  Scenario scenario = briefly_free(free);
  const auto shell = once([scenario] { return make_shell(scenario); });
  const auto fresh = once([=] { return sampled_run(scenario, shell(), 1).positions; });
  Panel panel;
  for (const Skips skips : {Skips::on, Skips::off}) {
    scenario.rendering.skips = skips;
    panel.push_back({skips == Skips::on ? "skips/taken" : "skips/off", "step",
                     [=] { return off_the_fresh(scenario, shell(), fresh()); },
                     [=] { return bare_run(scenario, shell()); }});
  }
  return panel;
}

Panel events(const Scenario& thrown) {
  const Scenario scenario = bouncing(thrown);
  const auto shell = once([scenario] { return make_shell(scenario); });
  const auto measured = [shell](const Scenario& run) {
    MechanicalEnergy energy(run.rendering.mass);
    const Outcome outcome = sampled_run(run, shell(), 1, {&energy}).result.outcome;
    return std::pair(outcome, energy);
  };
  // The law's own part: that of the integrator which finds the events inside a step.
  const auto reference =
      once([=] { return measured(with(scenario, kEvent, kStepFactors[std::size(kStepFactors) - 1])).second; });
  Panel panel;
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double factor : kStepFactors) {
      const Scenario run = with(scenario, *integrator, factor);
      const auto errors = [=]() -> Errors {
        const auto [outcome, energy] = measured(run);
        const bool complete = outcome != Outcome::diverges;
        return {std::string(outcome_name(outcome)),
                {{"step_s", run.time.step},
                 {"created_J", if_any(complete, energy.created())},
                 {"created_by_sampling_J", if_any(complete, energy.created() - reference().created())},
                 {"created_share", if_any(complete, energy.created() / reference().first())},
                 {"contact_on_off", energy.switches()}}};
      };
      panel.push_back({fmt::format("events/{} dt={}", integrator->info.name, run.time.step), "step", errors,
                       [=] { return bare_run(run, shell()); }});
    }
  }
  return panel;
}

}  // namespace hapbench::accuracy
