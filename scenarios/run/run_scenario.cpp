#include "scenarios/run/run_scenario.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>

#include "algorithms/registry.hpp"
#include "results/observe/sampling_spread.hpp"
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
#include "scenarios/run/rigid_contact_force.hpp"
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
                          .reduction_capacity = if_any(rendering.reduction.has_value(), parts.source->capacity()),
                          .stride = static_cast<std::uint64_t>(scenario.time.stride)};
  // If the position is prescribed or a handle moves the tool, no integrator applies the friction force, and
  // explicit_friction_limit() does not apply.
  if (parts.motion->position_is_free() && !handle_moves_tool(scenario.device))
    config.friction_limit = explicit_friction_limit(*scenario.integrator.type, rendering.mass, scenario.time.step,
                                                    rendering.mu_s, rendering.mu_f);
  return config;
}

/// Returns the force with which the rendered force is compared: an ideal force, or the measured force in the file of a
/// recorded stroke. Null if there is no such force.
std::shared_ptr<const ReferenceForce> reference_force(const Scenario& scenario, const NamedFiles& files) {
  if (scenario.reference_force) {
    if (const auto* given = std::get_if<GivenForceFields>(&*scenario.reference_force))
      return std::make_shared<const ReferenceForce>(given->force);
    return rigid_contact_force(scenario, files);
  }
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

/// State of a run: the observers that are used in all trials, and the results so far.
class Run {
 public:
  Run(const CheckedScenario& checked, const std::shared_ptr<const PointShell>& shell, std::size_t trials,
      Diagnose diagnose, RunLength length)
      : checked_(checked),
        scenario_(checked.scenario()),
        shell_(shell),
        length_(length),
        diagnose_(diagnose),
        reference_(reference_force(scenario_, checked.files())),
        sections_(scenario_, reference_ != nullptr) {
    if (scenario_.record.timing) times_.emplace(static_cast<std::size_t>(scenario_.time.steps) * trials);
    if (diagnose != Diagnose::nothing) diagnosis_.emplace(scenario_);
  }

  /// Runs a trial. `target`: destination of the recorded tables; empty: nothing is recorded. `label`: label of the
  /// progress bar; empty: no bar.
  void run_trial(Trial trial, const std::optional<RecordTarget>& target, const std::string& label,
                 const ProgressListener* listener) {
    // Build the parts, and notify the observers that a trial begins.
    SimulationParts parts = assemble(scenario_, checked_.files(), shell_, trial);
    const SimulationConfig config = simulation_config(scenario_);
    const TrialParts trial_parts{config, parts, reference_.get(), trial.subject, trial.number};
    const TimeFields& time = scenario_.time;
    if (!metrics_) {
      const double counted_step = time.step * static_cast<double>(time.stride);
      const MetricsConfig metrics = metrics_config(scenario_, parts);
      metrics_.emplace(counted_step, metrics);
      sampling_.emplace(counted_step, metrics);
    }
    metrics_->begin();
    sampling_->begin();
    sections_.begin(trial_parts);
    tool_ = parts.tool;

    // Collect the observers, in the order in which they are notified. The sampler is notified first and last, so that
    // it can exclude the time of all other observers.
    StepSampler sampler(static_cast<std::uint64_t>(time.steps));
    const auto outcome = outcome_observer(scenario_, checked_.files(), parts, &*metrics_, length_);
    ProgressBar bar(label, static_cast<std::uint64_t>(time.steps), listener);
    std::vector<Observer*> observers = {&sampler, &*metrics_};
    for (MetricsObserver& observer : sampling_->observers()) observers.push_back(&observer);
    for (const auto& observer : sections_.all()) observers.push_back(observer.get());
    observers.push_back(outcome.get());
    if (diagnosis_) {
      diagnosis_->begin(*outcome);
      observers.push_back(&*diagnosis_);
    }
    if (target) {
      for (auto& recorder :
           make_recorders({scenario_.record, parts.source->capacity(), sections_, outcome->inside()}, *target)) {
        observers.push_back(recorder.get());
        recorders_.push_back(std::move(recorder));
      }
    }
    observers.push_back(&sampler);

    // Run the trial and evaluate it.
    Simulation simulation(config, std::move(parts), std::move(observers));
    const SimulationResult result = step_to_end(simulation, *outcome, bar);
    step_nanoseconds_.insert(step_nanoseconds_.end(), sampler.nanoseconds().begin(), sampler.nanoseconds().end());
    end_trial(*outcome, result);
  }

  /// Returns the result. Called once, after all trials.
  Result result() {
    Result result = std::move(result_);
    result.name = scenario_.name;
    result.algorithm = scenario_.rendering.algorithm;
    result.duration = static_cast<double>(result.end.rows) * scenario_.time.step;
    sections_.report(*metrics_, inside_ ? &*inside_ : nullptr, result);
    sampling_->write(result.metrics);
    if (result.end.ended_at) remove_values(result);
    result.state_hash = metrics_->state_hash();
    result.warnings = checked_.file_warnings();
    // With several trials, name the first trial that has warnings.
    if (trials_ > 1) {
      for (Warning& warning : warnings_)
        warning.text = fmt::format("in {} of {} trials, first in trial {}: {}", with_warnings_, trials_,
                                   first_with_warnings_, warning.text);
    }
    for (const auto& more :
         {warnings_, tool_warnings(scenario_.rendering, *tool_),
          diagnose_ == Diagnose::everything ? std::vector<Warning>() : rule_warnings(checked_.loaded(), result)})
      result.warnings.insert(result.warnings.end(), more.begin(), more.end());
    // Describe a tool that is not a cylinder. The fields of the scenario describe a cylinder completely.
    if (!std::holds_alternative<CylinderFields>(scenario_.tool)) result.tool = tool_json(*tool_);
    if (const auto* targets = sections_.find<TargetMetricsObserver>()) result.targets = targets->rows();
    if (diagnose_ == Diagnose::everything)
      result.diagnosis = diagnosis_findings(checked_.loaded(), result, diagnosis_->rows(), *tool_, shell_);
    if (diagnose_ == Diagnose::low_vibration)
      result.low_vibration = low_vibration_numbers(checked_.loaded(), result, diagnosis_->rows(), *tool_, shell_);
    // Report the times of single steps if there are enough samples.
    const StepLatency alone = step_latency(step_nanoseconds_, 0);
    result.timing.step_p50 = if_any(alone.steps > 0, 1e-9 * static_cast<double>(alone.p50));
    result.timing.step_p99 = if_any(alone.steps >= 100, 1e-9 * static_cast<double>(alone.p99));
    if (times_) result.timing.latency = step_latency(times_->nanoseconds(), times_->overhead());
    return result;
  }

  /// Returns the recorders of all trials. Their files have temporary names until Recorder::finish().
  const Recorders& recorders() const { return recorders_; }

 private:
  /// Makes all steps of a trial. At a final failure, removes the observers. If the failure is a loss of contact, the
  /// trial ends. If the failure is a passage through the surface, the trial continues without observers, because the
  /// trial may still diverge.
  SimulationResult step_to_end(Simulation& simulation, const OutcomeObserver& outcome, ProgressBar& bar) {
    // Measure allocations, preemptions and time of the step loop.
    const AllocationCount allocations;
    const std::uint64_t preemptions_before = involuntary_context_switches();
    const auto start = Clock::now();
    if (times_) times_->start();
    const std::optional<FinalFailure>& failure = outcome.final_failure();
    std::optional<std::uint64_t> observed;  // number of observed steps, if the run fails for good
    SimulationResult result = run_to_end(simulation, [&] {
      bar.show(simulation.next_row());
      bool more = true;
      for (std::uint64_t i = 0; i < kStepsPerStopCheck && (more = simulation.step()); ++i) {
        if (times_) times_->lap();
        if (!failure || observed) continue;
        observed = simulation.result().rows;
        simulation.drop_observers();
        if (failure->outcome != Outcome::went_through) return false;
      }
      return more;
    });
    if (failure) {
      result_.end.ended_at = failure->time;
      result.rows = *observed;
    }
    result_.timing.loop += std::chrono::duration<double>(Clock::now() - start).count();
    result_.timing.preemptions += involuntary_context_switches() - preemptions_before;
    result_.work += work_of(simulation, allocations.value());
    return result;
  }

  void end_trial(OutcomeObserver& observer, const SimulationResult& result) {
    const Outcome outcome = observer.outcome(result.ending);
    // Keep the warnings of the first trial that has warnings.
    std::vector<Warning> warnings = observer.warnings(outcome);
    ++trials_;
    if (!warnings.empty() && with_warnings_++ == 0) {
      first_with_warnings_ = trials_;
      warnings_ = std::move(warnings);
    }
    const bool diverges = outcome == Outcome::diverges && !outcome_is_expected(scenario_.expect, outcome);
    const bool single = !std::holds_alternative<TrackingHandFields>(scenario_.hand);
    if (length_ == RunLength::until_failure && diverges && single && !result_.end.ended_at)
      result_.end.ended_at = result.divergence.time;
    if (const InsideDepths* depths = result_.end.ended_at ? nullptr : observer.depths()) {
      if (inside_)
        inside_->add(*depths);
      else
        inside_ = *depths;
    }
    if (diagnosis_) {
      diagnosis_->add_longest_step(observer.longest_step());
      diagnosis_->add_facts(observer.facts());
    }
    // If a trial diverges, the subject fails its remaining targets.
    if (outcome == Outcome::diverges) {
      if (auto* targets = sections_.find<TargetMetricsObserver>()) targets->fail_rest();
    }
    // Set the outcome of the run to the worst outcome of its trials, which is the last in the order of Outcome. Add the
    // number of steps of this trial.
    const std::uint64_t rows = result.rows + result_.end.rows;
    if (trials_ == 1 || outcome > result_.end.outcome)
      result_.end = {outcome, rows, result.divergence, result_.end.ended_at};
    result_.end.rows = rows;
  }

  /// Removes all numbers from the result of a run that ended at its failure, because they would describe only a part of
  /// the run.
  static void remove_values(Result& result) {
    for (Metric& metric : result.metrics) metric.value = {};
    for (auto& section : result.sections) {
      for (auto& member : section) member = member.is_array() ? Json::array() : Json();
    }
  }

  const CheckedScenario& checked_;
  const Scenario& scenario_;
  const std::shared_ptr<const PointShell>& shell_;
  RunLength length_;
  Diagnose diagnose_;
  std::shared_ptr<const ReferenceForce> reference_;
  std::shared_ptr<const ToolShape> tool_;
  std::optional<MetricsObserver> metrics_;  ///< created when the first trial begins, like `sampling_`
  std::optional<SamplingSpread> sampling_;
  SectionObservers sections_;
  std::optional<DiagnosisObserver> diagnosis_;  ///< empty with Diagnose::nothing
  std::optional<InsideDepths> inside_;
  std::optional<StepTimes> times_;               ///< times of all steps; empty unless requested
  std::vector<std::uint64_t> step_nanoseconds_;  ///< sampled durations of single steps [ns] (StepSampler)
  std::vector<Warning> warnings_;                ///< warnings of the first trial that has warnings
  std::size_t trials_ = 0, with_warnings_ = 0, first_with_warnings_ = 0;
  Result result_;  ///< result so far: end, work, and times of the step loop
  Recorders recorders_;
};

}  // namespace

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the phases of a run, one after the other.
Result run_scenario(const CheckedScenario& checked, const std::optional<RunOutput>& output, Progress progress,
                    RunTables* tables, Diagnose diagnose, std::shared_ptr<const PointShell> shell, RunLength length) {
  const Scenario& scenario = checked.scenario();
  const auto start = Clock::now();
  // Build the point shell, unless the caller gives a point shell.
  if (!shell) {
    const WaitNotice notice(scenario.name + ": computing the point shell", progress.is_shown);
    shell = make_shell(scenario, checked.files());
  }
  const std::chrono::duration<double> shell_time = Clock::now() - start;
  // Run the trials.
  const std::vector<Trial> trials = trials_of(scenario);
  std::optional<ResultFolder> folder;
  if (output) folder.emplace(*output);
  if (output) tables = nullptr;
  // Reserve memory for the tables of all trials, because the recorders keep pointers to these tables.
  if (tables != nullptr) tables->trials.reserve(trials.size());
  Run run(checked, shell, trials.size(), diagnose, length);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    std::optional<RecordTarget> target;
    if (folder && records_rows(scenario.record)) target = folder->trial_directory(trials[i], trials.size());
    if (tables != nullptr) target = &tables->trials.emplace_back();
    std::string label = progress.is_shown ? scenario.name : "";
    if (progress.is_shown && trials.size() > 1) label += fmt::format(" {}/{}", i + 1, trials.size());
    run.run_trial(trials[i], target, label, progress.listener);
  }
  // Evaluate the run and compare it with the scenario's expectations.
  Result result = run.result();
  result.timing.shell = shell_time.count();
  // Compare only the outcome if the run ended at its failure, because its metrics have no values.
  const ExpectFields outcomes{scenario.expect.outcomes, {}};
  result.unmet = unmet_expectations(result.end.ended_at ? outcomes : scenario.expect, result);
  result.expected = result.unmet.empty();
  if (!folder && tables == nullptr) return result;
  // Describe where the results come from, and write them.
  const AlgorithmOrigin& origin = find_algorithm(result.algorithm)->origin;
  result.provenance = provenance();
  result.provenance.plugin = origin.file;
  result.provenance.plugin_hash = origin.hash;
  const Json effective = effective_scenario(scenario, output ? output->directory : fs::current_path());
  result.scenario_hash = scenario_hash(effective, checked.files());
  if (folder) result.replaces_other = folder->write(scenario.record, effective, result, run.recorders());
  if (tables != nullptr) tables->write(effective, result, run.recorders());
  return result;
}

}  // namespace hapbench
