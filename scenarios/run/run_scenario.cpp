#include "scenarios/run/run_scenario.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>

#include "algorithms/registry.hpp"
#include "results/observe/step_times.hpp"
#include "results/summary/allocations.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/trials.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

MetricsConfig metrics_config(const Scenario& scenario, const SimulationParts& parts) {
  const RenderingConfig& rendering = scenario.rendering;
  MetricsConfig config = {.settling = scenario.metrics,
                          .steps = static_cast<std::uint64_t>(scenario.time.steps / scenario.time.stride),
                          .most_reduced = if_any(rendering.reduction.has_value(), parts.source->capacity()),
                          .stride = static_cast<std::uint64_t>(scenario.time.stride)};
  // Where the position is prescribed, or a handle moves the tool, no integrator steps the friction.
  if (parts.motion->position_is_free() && !handle_moves_tool(scenario.device))
    config.friction_limit = explicit_friction_limit(*scenario.integrator.type, rendering.mass, scenario.time.step,
                                                    rendering.mu_s, rendering.mu_f);
  return config;
}

/// The force that the rendered one is compared with: ideal, or measured with a stroke; null without.
std::shared_ptr<const ReferenceForce> reference_force(const Scenario& scenario, const NamedFiles& files) {
  if (scenario.reference_force) return std::make_shared<const ReferenceForce>(scenario.reference_force->force);
  if (!std::holds_alternative<RecordedPosition>(scenario.motion.position)) return nullptr;
  const auto stroke = files.at(kMotionFile).stroke();
  if (stroke->force) return {stroke, &*stroke->force};
  if (scenario.record.force_reference)
    throw InputError("/record/force_reference: got true; allowed: false, because the stroke has no measured force");
  return nullptr;
}

std::uint64_t involuntary_context_switches() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_nivcsw);
}

RunWork work_of(const Simulation& simulation, std::uint64_t allocations) {
  RunWork work;
  work.allocations = allocations;
  work.search = simulation.source().work();
  work.steps_skipped = work.search.skipped;
  work.algorithm = simulation.algorithm().work();
  work.search += work.algorithm.search;
  return work;
}

/// A run between its trials: the observers that go on from trial to trial, and what the trials gave so far.
class Run {
 public:
  Run(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell, std::size_t trials, bool diagnose)
      : loaded_(loaded),
        scenario_(loaded.scenario),
        shell_(shell),
        reference_(reference_force(scenario_, loaded.files)),
        sections_(scenario_, reference_ != nullptr) {
    if (scenario_.record.timing) times_.emplace(static_cast<std::size_t>(scenario_.time.steps) * trials);
    if (diagnose) diagnosis_.emplace(scenario_);
  }

  /// Makes a trial, which records to `target`, if that is given. `label` is that of the progress bar; empty for none.
  void make(Trial trial, const std::optional<RecordTarget>& target, const std::string& label) {
    SimulationParts parts = assemble(scenario_, loaded_.files, shell_, trial);
    const SimulationConfig config = simulation_config(scenario_);
    const TrialParts begun{config, parts, reference_.get(), trial.subject, trial.number};
    const TimeFields& time = scenario_.time;
    if (!metrics_) metrics_.emplace(time.step * static_cast<double>(time.stride), metrics_config(scenario_, parts));
    metrics_->begin();
    sections_.begin(begun);
    tool_ = parts.tool;

    StepSampler sampler(static_cast<std::uint64_t>(time.steps));
    const auto seen = outcome_observer(scenario_, loaded_.files, parts, &*metrics_);
    ProgressBar bar(label, static_cast<std::uint64_t>(time.steps));
    std::vector<Observer*> observers = {&sampler, &*metrics_};
    for (const auto& observer : sections_.all()) observers.push_back(observer.get());
    observers.push_back(seen.get());
    if (diagnosis_) observers.push_back(&*diagnosis_);
    if (target) {
      for (auto& recorder :
           make_recorders({scenario_.record, parts.source->capacity(), sections_, seen->inside()}, *target)) {
        observers.push_back(recorder.get());
        recorders_.push_back(std::move(recorder));
      }
    }
    observers.push_back(&sampler);

    Simulation simulation(config, std::move(parts), std::move(observers));
    const SimulationResult result = step_to_end(simulation, bar);
    step_nanoseconds_.insert(step_nanoseconds_.end(), sampler.nanoseconds().begin(), sampler.nanoseconds().end());
    end_trial(*seen, result);
  }

  /// After the trials.
  Result result() {
    Result result = std::move(result_);
    result.name = scenario_.name;
    result.algorithm = scenario_.rendering.algorithm;
    result.duration = static_cast<double>(result.end.rows) * scenario_.time.step;
    sections_.tell(*metrics_, inside_ ? &*inside_ : nullptr, result);
    result.state_hash = metrics_->state_hash();
    result.warnings = loaded_.file_warnings;
    if (trials_ > 1) {
      for (Warning& warning : warnings_)
        warning.text = fmt::format("in {} of {} trials, first in trial {}: {}", with_warnings_, trials_,
                                   first_with_warnings_, warning.text);
    }
    for (const auto& more : {warnings_, tool_warnings(scenario_.rendering, *tool_),
                             diagnosis_ ? std::vector<Warning>() : rule_warnings(loaded_, result)})
      result.warnings.insert(result.warnings.end(), more.begin(), more.end());
    // The fields of a cylinder say all.
    if (!std::holds_alternative<CylinderFields>(scenario_.tool)) result.tool = tool_json(*tool_);
    if (const auto* targets = sections_.find<TargetMetricsObserver>()) result.targets = targets->rows();
    if (diagnosis_) result.diagnosis = diagnosis_findings(loaded_, result, diagnosis_->rows(), *tool_);
    const StepLatency alone = step_latency(step_nanoseconds_, 0);
    result.timing.step_p50 = if_any(alone.steps > 0, 1e-9 * static_cast<double>(alone.p50));
    result.timing.step_p99 = if_any(alone.steps >= 100, 1e-9 * static_cast<double>(alone.p99));
    if (times_) result.timing.latency = step_latency(times_->nanoseconds(), times_->overhead());
    return result;
  }

  /// Their files are complete but under temporary names until `finish`.
  const Recorders& recorders() const { return recorders_; }

 private:
  SimulationResult step_to_end(Simulation& simulation, ProgressBar& bar) {
    const AllocationCount allocations;
    const std::uint64_t preemptions_before = involuntary_context_switches();
    const auto start = Clock::now();
    if (times_) times_->start();
    SimulationResult result = run_to_end(simulation, [&] {
      bar.show(simulation.next_row());
      if (!times_) return simulation.advance(kAskEvery);
      bool more = true;
      for (std::uint64_t i = 0; i < kAskEvery && (more = simulation.step()); ++i) times_->lap();
      return more;
    });
    result_.timing.loop += std::chrono::duration<double>(Clock::now() - start).count();
    result_.timing.preemptions += involuntary_context_switches() - preemptions_before;
    result_.work += work_of(simulation, allocations.value());
    return result;
  }

  void end_trial(OutcomeObserver& seen, const SimulationResult& result) {
    const Outcome outcome = seen.outcome(result.ending);
    std::vector<Warning> warnings = seen.warnings(outcome);
    ++trials_;
    if (!warnings.empty() && with_warnings_++ == 0) {
      first_with_warnings_ = trials_;
      warnings_ = std::move(warnings);
    }
    if (const InsideDepths* depths = seen.depths()) {
      if (inside_)
        inside_->add(*depths);
      else
        inside_ = *depths;
    }
    if (diagnosis_) diagnosis_->add_longest_step(seen.longest_step());
    // A subject who loses the drill fails the rest of the targets.
    if (outcome == Outcome::diverges) {
      if (auto* targets = sections_.find<TargetMetricsObserver>()) targets->fail_rest();
    }
    const std::uint64_t rows = result.rows + result_.end.rows;
    if (trials_ == 1 || outcome > result_.end.outcome) result_.end = {outcome, rows, result.divergence};
    result_.end.rows = rows;
  }

  const LoadedScenario& loaded_;
  const Scenario& scenario_;
  const std::shared_ptr<const PointShell>& shell_;
  std::shared_ptr<const ReferenceForce> reference_;
  std::shared_ptr<const ToolShape> tool_;
  std::optional<MetricsObserver> metrics_;  ///< made from the parts of the first trial
  SectionObservers sections_;
  std::optional<DiagnosisObserver> diagnosis_;  ///< if it is wanted
  std::optional<InsideDepths> inside_;
  std::optional<StepTimes> times_;               ///< of every step, if they are wanted
  std::vector<std::uint64_t> step_nanoseconds_;  ///< samples of the time of single steps (StepSampler)
  std::vector<Warning> warnings_;                ///< of the first trial that has some
  std::size_t trials_ = 0, with_warnings_ = 0, first_with_warnings_ = 0;
  Result result_;  ///< so far: end, work, and the times of the step loop
  Recorders recorders_;
};

/// The trials of a scenario, subject by subject; most scenarios have one.
std::vector<Trial> trials_of(const Scenario& scenario) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return {Trial{}};
  std::vector<Trial> trials;
  for (std::size_t subject = 0; subject < hand->subjects.size(); ++subject)
    for (std::size_t number = 0; number < static_cast<std::size_t>(hand->trials); ++number)
      trials.push_back({subject, number});
  return trials;
}

}  // namespace

Result run_scenario(const LoadedScenario& loaded, const std::optional<fs::path>& output, bool progress,
                    RunTables* tables, bool diagnose, std::shared_ptr<const PointShell> shell) {
  const Scenario& scenario = loaded.scenario;
  const auto start = Clock::now();
  if (!shell) {
    const WaitNotice notice(scenario.name + ": computing the point shell", progress);
    shell = make_shell(scenario, loaded.files);
  }
  const std::chrono::duration<double> shell_time = Clock::now() - start;
  const std::vector<Trial> trials = trials_of(scenario);
  std::optional<ResultFolder> folder;
  if (output) folder.emplace(*output);
  if (output) tables = nullptr;
  if (tables != nullptr) tables->trials.reserve(trials.size());  // the recorders point into it
  Run run(loaded, shell, trials.size(), diagnose);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    std::optional<RecordTarget> target;
    if (folder && records_rows(scenario.record)) target = folder->of_trial(trials[i], trials.size());
    if (tables != nullptr) target = &tables->trials.emplace_back();
    std::string label = progress ? scenario.name : "";
    if (progress && trials.size() > 1) label += fmt::format(" {}/{}", i + 1, trials.size());
    run.make(trials[i], target, label);
  }
  Result result = run.result();
  result.timing.shell = shell_time.count();
  result.unmet = unmet_expectations(scenario.expect, result);
  result.expected = result.unmet.empty();
  if (!folder && tables == nullptr) return result;
  const AlgorithmOrigin& origin = find_algorithm(result.algorithm)->origin;
  result.provenance = provenance();
  result.provenance.plugin = origin.file;
  result.provenance.plugin_hash = origin.hash;
  const Json effective = effective_scenario(scenario, output ? *output : fs::current_path());
  result.scenario_hash = scenario_hash(effective, loaded.files);
  if (folder) result.replaces_other = folder->write(scenario.record, effective, result, run.recorders());
  if (tables != nullptr) tables->write(effective, result, run.recorders());
  return result;
}

}  // namespace hapbench
