#include "scenarios/run/run_scenario.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "results/allocations/allocations.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "results/io/json_text.hpp"
#include "results/observe/step_times.hpp"
#include "results/record/recorder.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The results of one trial; most scenarios have one.
struct TrialResult {
  SimulationResult result;
  std::shared_ptr<const ToolShape> tool;
  Metrics metrics;
  std::optional<PassivityMetrics> passivity;
  std::optional<SectionObservers> sections;  ///< never empty in a result of run_trial
  std::vector<std::string> warnings;         ///< about what may make the numbers mislead
  RunWork work;
  double loop_seconds = 0.0;                    ///< wall time of the step loop
  std::vector<std::uint64_t> step_nanoseconds;  ///< samples of the time of single steps (StepSampler)
  std::uint64_t preemptions = 0;                ///< involuntary context switches in the loop
  /// Their files are complete but under temporary names until `finish`.
  std::vector<std::unique_ptr<Recorder>> recorders;
};

/// The spring force beyond which the explicit step of friction is unstable [N]. Nothing where the position is
/// prescribed or a handle moves the tool, since no integrator does.
std::optional<double> friction_limit(const Scenario& scenario, const Motion& motion) {
  if (!motion.position_is_free() || handle_moves_tool(scenario.device)) return std::nullopt;
  const RenderingConfig& rendering = scenario.rendering;
  return explicit_friction_limit(*scenario.integrator.type, rendering.mass, scenario.time.step, rendering.mu_s,
                                 rendering.mu_f);
}

MetricsConfig metrics_config(const Scenario& scenario, const SimulationParts& parts) {
  MetricsConfig config;
  config.friction_limit = friction_limit(scenario, *parts.motion);
  config.settling = scenario.metrics;
  config.steps = static_cast<std::uint64_t>(scenario.time.steps / scenario.time.stride);
  if (scenario.rendering.reduction) config.most_reduced = parts.source->capacity();
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

/// Shows another observer every so manieth row, as one of a run with so much longer steps.
class RowsApart final : public Observer {
 public:
  RowsApart(Observer& observer, std::int64_t stride)
      : observer_(observer), stride_(static_cast<std::uint64_t>(stride)) {}

  bool wants_ratio() const noexcept override { return observer_.wants_ratio(); }
  void on_step(const StepRecord& record) noexcept override {
    if (record.step % stride_ != 0) return;
    StepRecord row = record;
    row.step /= stride_;
    observer_.on_step(row);
  }

 private:
  Observer& observer_;
  std::uint64_t stride_;
};

/// The observers of a trial: only those that the scenario asks for.
class TrialObservers {
 public:
  TrialObservers(const Scenario& scenario, const NamedFiles& files, const SimulationParts& parts, Trial trial)
      : tool_(parts.tool),
        metrics_(scenario.time.step * static_cast<double>(scenario.time.stride), metrics_config(scenario, parts)),
        metrics_rows_(metrics_, scenario.time.stride),
        passivity_(scenario.time.step, parts.motion->position_is_free()),
        seen_(scenario, files, parts, &metrics_),
        sections_({.scenario = scenario,
                   .simulation = parts,
                   .reference = reference_force(scenario, files),
                   .subject = trial.subject,
                   .trial = trial.number}) {
    observers_.push_back(scenario.time.stride == 1 ? static_cast<Observer*>(&metrics_) : &metrics_rows_);
    observers_.push_back(&passivity_);
    for (const auto& observer : sections_.all()) observers_.push_back(observer.get());
    for (Observer* observer : seen_.all()) observers_.push_back(observer);
    if (parts.shell && parts.shell->size() > 0) {
      // Needs shell indices; FCL and Bullet contacts have none.
      if (std::holds_alternative<MeshEnvironment>(scenario.environment) &&
          scenario.rendering.contact_source == kOwnContacts &&
          !files.at(kEnvironmentFile).mesh().open_edges().empty()) {
        open_edges_.emplace(*parts.shell, files.at(kEnvironmentFile).mesh().open_edges(), parts.tool->half_width());
        observers_.push_back(&*open_edges_);
      }
    }
  }

  /// Adds recorders for what the scenario asks for. Throws IoError.
  void record(const RecordFields& fields, const RecordTarget& target, std::size_t contact_capacity) {
    recorders_ = make_recorders({fields, contact_capacity, sections_, seen_.inside()}, target);
    for (const auto& recorder : recorders_) observers_.push_back(recorder.get());
  }

  void add(Observer& observer) { observers_.push_back(&observer); }
  const std::vector<Observer*>& all() const { return observers_; }

  /// Moves what was observed into the result.
  void move_to(const Scenario& scenario, TrialResult& out) {
    out.tool = tool_;
    out.metrics = metrics_.metrics();
    seen_.judge(out.metrics, out.result.outcome, out.warnings);
    if (open_edges_ && open_edges_->warning()) out.warnings.push_back(*open_edges_->warning());
    // A subject who loses the drill fails the rest of the targets.
    if (out.result.outcome == Outcome::diverges) {
      if (auto* targets = sections_.find<TargetMetricsObserver>()) targets->fail_rest();
    }
    out.passivity = passivity_.metrics();
    out.sections = std::move(sections_);
    out.recorders = std::move(recorders_);
  }

 private:
  std::shared_ptr<const ToolShape> tool_;
  MetricsObserver metrics_;
  RowsApart metrics_rows_;
  PassivityObserver passivity_;
  EncounterObservers seen_;
  SectionObservers sections_;
  std::optional<OpenEdgeObserver> open_edges_;
  std::vector<std::unique_ptr<Recorder>> recorders_;
  std::vector<Observer*> observers_;
};

/// Does what run_to_end does and times every step.
SimulationResult run_timed(Simulation& simulation, StepTimes& times) {
  times.start();
  for (bool more = true; more;) {
    throw_if_stopped();
    for (std::uint64_t i = 0; i < kAskEvery && (more = simulation.step()); ++i) times.lap();
  }
  throw_if_stopped();
  return simulation.result();
}

/// Number of involuntary context switches of this process so far.
std::uint64_t involuntary_context_switches() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_nivcsw);
}

/// Runs one trial and records into `target`, if there is one, whose directory exists. `label` is that of the progress
/// bar; empty for none. Every step is timed into `times`, if that is not null; `more`, if given, observes, too. Throws
/// Stopped when a signal ends the run.
TrialResult run_trial(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell, Trial trial,
                      const std::optional<RecordTarget>& target, const std::string& label, StepTimes* times,
                      Observer* more) {
  const Scenario& scenario = loaded.scenario;
  SimulationParts parts = assemble(scenario, loaded.files, shell, trial);
  TrialObservers observers(scenario, loaded.files, parts, trial);
  if (target) observers.record(scenario.record, *target, parts.source->capacity());
  Progress bar(label, static_cast<std::uint64_t>(scenario.time.steps), !label.empty());
  observers.add(bar);
  if (more != nullptr) observers.add(*more);
  StepSampler sampler(static_cast<std::uint64_t>(scenario.time.steps));
  std::vector<Observer*> all = observers.all();
  all.insert(all.begin(), &sampler.first());
  all.push_back(&sampler.last());
  Simulation simulation(simulation_config(scenario), std::move(parts), std::move(all));

  TrialResult out;
  const std::uint64_t allocations_before = heap_allocations();
  const std::uint64_t preemptions_before = involuntary_context_switches();
  const auto start = Clock::now();
  out.result = times != nullptr ? run_timed(simulation, *times) : run_to_end(simulation);
  out.loop_seconds = seconds_since(start);
  out.preemptions = involuntary_context_switches() - preemptions_before;
  out.work.allocations = heap_allocations() - allocations_before;
  out.work.search = simulation.source().work();
  out.work.steps_skipped = out.work.search.skipped;
  out.work.algorithm = simulation.algorithm().work();
  out.work.search += out.work.algorithm.search;
  out.step_nanoseconds.assign(sampler.nanoseconds().begin(), sampler.nanoseconds().end());
  observers.move_to(scenario, out);
  return out;
}

/// The trials of a scenario, subject by subject.
std::vector<Trial> trials_of(const Scenario& scenario) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return {Trial{}};
  std::vector<Trial> trials;
  for (std::size_t subject = 0; subject < hand->subjects.size(); ++subject) {
    for (std::size_t number = 0; number < static_cast<std::size_t>(hand->trials); ++number) {
      trials.push_back({subject, number});
    }
  }
  return trials;
}

constexpr const char* kTrialDirectory = "subject_";

/// The directory into which a trial records: that of the scenario when the trial is the only one.
fs::path trial_directory(const fs::path& directory, Trial trial, std::size_t trials) {
  if (trials == 1) return directory;
  return directory / fmt::format("{}{}_trial_{}", kTrialDirectory, trial.subject, trial.number);
}

/// Keeps two runs from writing into one folder: while one object holds a folder, another cannot be made, in any
/// process. File systems without locks are not guarded.
class FolderLock {
 public:
  /// Throws IoError.
  explicit FolderLock(const fs::path& directory)
      : descriptor_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    ::close(descriptor_);
    throw IoError("write, because another run writes to", directory,
                  std::make_error_code(std::errc::device_or_resource_busy));
  }
  ~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

void create_output(NewDirectories& directories, const fs::path& directory) {
  std::error_code error;
  directories.create(directory, error);
  if (error) throw IoError("create", directory, error);
}

std::vector<fs::path> trial_directories(const fs::path& directory) {
  std::error_code ignored;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    if (entry.is_directory(ignored) && entry.path().filename().string().starts_with(kTrialDirectory))
      found.push_back(entry.path());
  }
  return found;
}

/// Removes optional files that an earlier run with other settings may have left: they would not belong to this run.
void remove_earlier_run(const fs::path& directory, FileSet& files) {
  for (const char* name : {"summary.json", "columns.json", kTargetTable.file, "timing.json"})
    files.remove(directory / name);
  for (const ResultTable& table : record_tables()) files.remove(directory / table.file);
  for (const fs::path& trial : trial_directories(directory)) remove_earlier_run(trial, files);
}

/// Those that this run has not written to, unless somebody keeps other files there.
void remove_empty_trials(const fs::path& directory) {
  std::error_code ignored;
  for (const fs::path& trial : trial_directories(directory)) fs::remove(trial, ignored);
}

/// The result of all trials: the outcome is the worst of them.
SimulationResult merged_result(const std::vector<TrialResult>& trials) {
  SimulationResult all = trials.front().result;
  for (std::size_t i = 1; i < trials.size(); ++i) {
    const SimulationResult& result = trials[i].result;
    const std::uint64_t rows = all.rows + result.rows;
    if (result.outcome > all.outcome) all = result;
    all.rows = rows;
  }
  return all;
}

/// The warnings of the first trial that has any, with the number of trials that have some.
std::vector<std::string> merged_warnings(const std::vector<TrialResult>& trials) {
  const auto warns = [](const TrialResult& trial) { return !trial.warnings.empty(); };
  const auto first = std::find_if(trials.begin(), trials.end(), warns);
  if (first == trials.end()) return {};
  std::vector<std::string> warnings = first->warnings;
  if (trials.size() == 1) return warnings;
  const auto count = std::count_if(trials.begin(), trials.end(), warns);
  for (std::string& warning : warnings)
    warning = fmt::format("in {} of {} trials, first in number {}: {}", count, trials.size(),
                          first - trials.begin() + 1, warning);
  return warnings;
}

RunSummary summarise(const Scenario& scenario, const std::vector<TrialResult>& trials) {
  std::vector<Metrics> metrics;
  std::vector<std::optional<PassivityMetrics>> passivity;
  std::vector<const SectionObservers*> sections;
  for (const TrialResult& trial : trials) {
    metrics.push_back(trial.metrics);
    passivity.push_back(trial.passivity);
    sections.push_back(&*trial.sections);
  }
  RunSummary summary;
  summary.name = scenario.name;
  summary.algorithm = scenario.rendering.algorithm;
  summary.result = merged_result(trials);
  summary.duration = static_cast<double>(summary.result.rows) * scenario.time.step;
  summary.metrics = merged(metrics);
  summary.passivity = merged(passivity);
  summary.sections = SectionObservers::summarised(sections);
  for (const TrialResult& trial : trials) summary.work += trial.work;
  summary.warnings = merged_warnings(trials);
  const ToolShape& tool = *trials.front().tool;
  for (const auto& more : {force_warnings(summary.metrics), tool_warnings(scenario.rendering, tool)})
    summary.warnings.insert(summary.warnings.end(), more.begin(), more.end());
  // The fields of a cylinder say all.
  if (!std::holds_alternative<CylinderFields>(scenario.tool))
    summary.tool = ToolSummary{tool.half_width(), tool.reach(), tool.convex(), tool.outline()};
  return summary;
}

void add_step_times(const std::vector<TrialResult>& trials, RunTiming& timing) {
  std::vector<std::uint64_t> all;
  for (const TrialResult& trial : trials) {
    all.insert(all.end(), trial.step_nanoseconds.begin(), trial.step_nanoseconds.end());
  }
  if (all.empty()) return;
  const StepLatency latency = step_latency(all, 0);
  timing.step_p50 = 1e-9 * static_cast<double>(latency.p50);
  if (all.size() >= 100) timing.step_p99 = 1e-9 * static_cast<double>(latency.p99);
}

void finish_recorders(const std::vector<TrialResult>& trials, FileSet* files) {
  for (const TrialResult& trial : trials) {
    for (const auto& recorder : trial.recorders) recorder->finish(files);
  }
}

bool has_targets(const RunReport& report) {
  return report.summary.section("targets") != nullptr;
}

void finish_tables(RunTables& tables, const RunReport& report, const std::vector<TrialResult>& trials) {
  finish_recorders(trials, nullptr);
  if (has_targets(report)) write_target_table(&tables.targets.emplace(kTargetTable.columns), report.targets);
}

void write_results(const fs::path& directory, const Scenario& scenario, const RunReport& report,
                   const std::vector<TrialResult>& trials) {
  std::vector<ResultTable> tables = record_tables(scenario.record);
  if (has_targets(report)) tables.push_back(kTargetTable);
  FileSet files;
  remove_earlier_run(directory, files);
  finish_recorders(trials, &files);
  if (has_targets(report)) write_target_table(directory / kTargetTable.file, report.targets, &files);
  const auto add = [&](const char* name, const std::string& text) { files.write(directory / name, text); };
  add("scenario.effective.json", json_text(effective_scenario(scenario, directory)));
  add("columns.json", json_text(columns_json(tables, metric_list(report.summary))));
  if (scenario.record.timing) add("timing.json", timing_text(report.timing, instruction_set(), provenance()));
  // The summary, which says that a run is there, is the first to go and the last to come.
  add("summary.json", summary_text(report.summary));
  files.commit();
  remove_empty_trials(directory);
}

}  // namespace

void remove_run(const fs::path& directory) {
  std::error_code ignored;
  if (!fs::is_directory(directory, ignored)) return;
  FileSet files;
  remove_earlier_run(directory, files);
  files.remove(directory / "scenario.effective.json");
  files.commit();
  remove_empty_trials(directory);
}

RunReport run_scenario(const LoadedScenario& loaded, const std::optional<fs::path>& output, bool progress,
                       RunTables* tables, bool diagnose) {
  RunTiming timing;
  const auto shell = [&] {
    const WaitNotice notice(loaded.scenario.name + ": building the shell", progress);
    const auto start = Clock::now();
    auto made = make_shell(loaded.scenario, loaded.files);
    timing.shell = seconds_since(start);
    return made;
  }();
  return run_with_shell(loaded, shell, output, progress, timing, tables, diagnose);
}

RunReport run_with_shell(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
                         const std::optional<fs::path>& output, bool progress, const RunTiming& timing,
                         RunTables* tables, bool diagnose) {
  const Scenario& scenario = loaded.scenario;
  RunReport report;
  report.timing = timing;
  const std::vector<Trial> trials = trials_of(scenario);
  NewDirectories directories;
  std::optional<FolderLock> lock;
  if (output) {
    create_output(directories, *output);
    lock.emplace(*output);
  }
  if (tables != nullptr) tables->trials.resize(trials.size());

  std::optional<StepTimes> times;
  if (scenario.record.timing) times.emplace(static_cast<std::size_t>(scenario.time.steps) * trials.size());
  std::optional<DiagnosisObserver> rows;
  if (diagnose) rows.emplace(scenario, shell.get());
  std::vector<TrialResult> results;
  for (const Trial trial : trials) {
    std::optional<RecordTarget> target;
    if (output && records_rows(scenario.record)) {
      const fs::path directory = trial_directory(*output, trial, trials.size());
      create_output(directories, directory);
      target = directory;
    } else if (tables != nullptr) {
      target = &tables->trials[results.size()];
    }
    std::string label = progress ? scenario.name : "";
    if (progress && trials.size() > 1) label += fmt::format(" {}/{}", results.size() + 1, trials.size());
    results.push_back(
        run_trial(loaded, shell, trial, target, label, times ? &*times : nullptr, rows ? &*rows : nullptr));
  }

  for (const TrialResult& result : results) {
    if (const auto* targets = result.sections->find<TargetMetricsObserver>())
      report.targets.insert(report.targets.end(), targets->rows().begin(), targets->rows().end());
    report.timing.loop += result.loop_seconds;
    report.timing.steps += result.result.rows;
    report.timing.preemptions += result.preemptions;
  }
  add_step_times(results, report.timing);
  if (times) report.timing.latency = step_latency(times->nanoseconds(), times->overhead());
  report.summary = summarise(scenario, results);
  report.summary.file_warnings = named_file_warnings(loaded);
  if (rows) report.summary.diagnosis = rows->findings(loaded, report.summary, *results.front().tool);
  if (output || tables != nullptr) {
    report.summary.provenance = provenance();
    const AlgorithmOrigin& origin = find_algorithm(scenario.rendering.algorithm)->origin;
    report.summary.provenance.plugin = origin.file;
    report.summary.provenance.plugin_hash = origin.hash;
    report.summary.scenario_hash = scenario_hash(scenario, loaded.files);
  }
  report.unmet = unmet_expectations(scenario.expect, report.summary);
  report.summary.expected = report.unmet.empty();
  if (output) {
    write_results(*output, scenario, report, results);
  } else if (tables != nullptr) {
    finish_tables(*tables, report, results);
  }
  return report;
}

}  // namespace hapbench
