#include "scenarios/run/run_trial.hpp"

#include <sys/resource.h>

#include <chrono>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/record/contact_recorder.hpp"
#include "results/record/energy_recorder.hpp"
#include "results/record/ideal_trajectory_recorder.hpp"
#include "results/record/ratio_recorder.hpp"
#include "results/record/stiffness_recorder.hpp"
#include "results/record/trajectory_recorder.hpp"
#include "scenarios/run/allocations.hpp"
#include "scenarios/run/progress.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

Mat3 start_shaping(ContactBuffer& contacts) noexcept {
  return shape_weights(contacts, 0);
}

/// Those who watch a trial: what the scenario asks for and nothing else.
class TrialObservers {
 public:
  TrialObservers(const Scenario& scenario, const SimulationParts& parts, Trial trial)
      : metrics_(scenario.time.step), passivity_(scenario.time.step) {
    observers_.push_back(&metrics_);
    observers_.push_back(&passivity_);
    if (scenario.record.energy) {
      ledger_.emplace(scenario.rendering.mass, scenario.time.step, parts.motion->position_is_free(),
                      parts.source->capacity(), scenario.integrator.type->holds_force);
      observers_.push_back(&*ledger_);
    }
    if (scenario.record.ideal_trajectory) {
      ideal_.emplace(std::get<BlockEnvironment>(scenario.environment).block, make_cylinder(scenario.tool));
      observers_.push_back(&*ideal_);
    }
    if (const TargetTask* task = parts.hand->task()) {
      targets_.emplace(trial.subject, trial.number, task->targets());
      observers_.push_back(&*targets_);
    }
  }

  /// Recorders for what the scenario asks for. Throws IoError.
  void record(const RecordFields& fields, const fs::path& directory, std::size_t contact_capacity) {
    const auto every = static_cast<std::uint64_t>(fields.every);
    if (fields.trajectory) add(std::make_unique<TrajectoryRecorder>(directory / "trajectory.csv", every));
    if (fields.contacts) add(std::make_unique<ContactRecorder>(directory / "contacts.csv", every));
    if (fields.stiffness_tensor) {
      add(std::make_unique<StiffnessRecorder>(directory / "stiffness_tensor.csv", every));
    }
    if (!fields.ratio_iterations.empty()) {
      const std::vector<int> iterations(fields.ratio_iterations.begin(), fields.ratio_iterations.end());
      const ShapingOperations shaping{start_shaping, update_shaped_weights};
      add(std::make_unique<RatioRecorder>(directory / "ratios.csv", every, iterations, shaping, contact_capacity));
    }
    if (ledger_) add(std::make_unique<EnergyRecorder>(directory / "energy.csv", every, *ledger_));
    if (ideal_) add(std::make_unique<IdealTrajectoryRecorder>(directory / "ideal_trajectory.csv", every, *ideal_));
  }

  void add(Observer& observer) { observers_.push_back(&observer); }
  const std::vector<Observer*>& all() const { return observers_; }

  /// Hands over what was observed.
  void give(TrialResult& out) {
    out.metrics = metrics_.metrics();
    out.passivity = passivity_.metrics();
    if (ledger_) out.energy = ledger_->metrics();
    if (ideal_) out.ideal_trajectory = ideal_->metrics();
    if (targets_) out.targets = targets_->rows();
    out.recorders = std::move(recorders_);
  }

 private:
  void add(std::unique_ptr<Recorder> recorder) {
    observers_.push_back(recorder.get());
    recorders_.push_back(std::move(recorder));
  }

  MetricsObserver metrics_;
  PassivityObserver passivity_;
  std::optional<EnergyLedger> ledger_;
  std::optional<IdealTrajectoryObserver> ideal_;
  std::optional<TargetMetricsObserver> targets_;
  std::vector<std::unique_ptr<Recorder>> recorders_;
  std::vector<Observer*> observers_;
};

SimulationResult run_timed(Simulation& simulation, StepTimes& times) noexcept {
  times.start();
  while (simulation.step()) times.lap();
  return simulation.result();
}

/// Of this process so far.
std::uint64_t involuntary_context_switches() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_nivcsw);
}

}  // namespace

TrialResult run_trial(const Scenario& scenario, std::shared_ptr<const PointShell> shell, Trial trial,
                      const TrialOptions& options) {
  SimulationParts parts = assemble(scenario, std::move(shell), trial, options.skips);
  TrialObservers observers(scenario, parts, trial);
  if (options.directory) observers.record(scenario.record, *options.directory, parts.source->capacity());
  Progress bar(options.label, static_cast<std::uint64_t>(scenario.time.steps), !options.label.empty());
  observers.add(bar);
  Simulation simulation(simulation_config(scenario, options.skips), std::move(parts), observers.all());

  TrialResult out;
  const std::uint64_t allocations_before = heap_allocations();
  const std::uint64_t preemptions_before = involuntary_context_switches();
  const auto start = std::chrono::steady_clock::now();
  out.result = options.times != nullptr ? run_timed(simulation, *options.times) : simulation.run();
  out.loop_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.preemptions = involuntary_context_switches() - preemptions_before;
  out.work.allocations = heap_allocations() - allocations_before;
  out.work.search = simulation.source().work();
  out.work.steps_skipped = out.work.search.skipped;
  out.work.algorithm = simulation.algorithm().work();
  out.work.search += out.work.algorithm.search;
  observers.give(out);
  return out;
}

}  // namespace hapbench
