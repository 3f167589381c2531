#include "scenarios/run/run_scenario.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "results/io/json_text.hpp"
#include "results/record/recorder.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/run/run_trial.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
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

/// Where a trial records: the scenario's directory itself when it is the only one.
fs::path trial_directory(const fs::path& directory, Trial trial, std::size_t trials) {
  if (trials == 1) return directory;
  return directory / fmt::format("{}{}_trial_{}", kTrialDirectory, trial.subject, trial.number);
}

void create_output(NewDirectories& directories, const fs::path& directory) {
  std::error_code error;
  directories.create(directory, error);
  if (error) throw IoError("create", directory, error);
  remove_stale_temporaries(directory);
}

/// Optional files that an earlier run with other settings may have left: they would not belong to this run.
void remove_files_of_earlier_runs(const fs::path& directory) {
  std::error_code ignored;
  std::vector<std::string> files = {"summary.json", "columns.json", kTargetTable.file, "timing.json"};
  for (const ResultTable& table : record_tables()) files.emplace_back(table.file);
  for (const std::string& name : files) fs::remove(directory / name, ignored);
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    if (!entry.is_directory(ignored) || !entry.path().filename().string().starts_with(kTrialDirectory)) continue;
    remove_files_of_earlier_runs(entry.path());
    fs::remove(entry.path(), ignored);  // unless somebody keeps other files there
  }
}

/// Several trials end as the worst of them does.
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

/// Those of the first trial that has any, and how many others have some.
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
  // A cylinder's fields say all.
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

void finish_recorders(const std::vector<TrialResult>& trials) {
  for (const TrialResult& trial : trials) {
    for (const auto& recorder : trial.recorders) recorder->finish();
  }
}

bool has_targets(const RunReport& report) {
  return report.summary.section("targets") != nullptr;
}

void finish_tables(RunTables& tables, const RunReport& report, const std::vector<TrialResult>& trials) {
  finish_recorders(trials);
  if (has_targets(report)) write_target_table(&tables.targets.emplace(kTargetTable.columns), report.targets);
}

void write_results(const fs::path& directory, const Scenario& scenario, const RunReport& report,
                   const std::vector<TrialResult>& trials) {
  remove_files_of_earlier_runs(directory);
  finish_recorders(trials);
  write_file_atomically(directory / "scenario.effective.json", json_text(effective_scenario(scenario, directory)));
  std::vector<ResultTable> tables = record_tables(scenario.record);
  if (has_targets(report)) {
    write_target_table(directory / kTargetTable.file, report.targets);
    tables.push_back(kTargetTable);
  }
  write_file_atomically(directory / "columns.json", json_text(columns_json(tables, metric_list(report.summary))));
  if (scenario.record.timing) {
    write_file_atomically(directory / "timing.json", timing_text(report.timing, instruction_set(), provenance()));
  }
  write_file_atomically(directory / "summary.json", summary_text(report.summary));
}

}  // namespace

void remove_run(const fs::path& directory) {
  std::error_code ignored;
  if (!fs::is_directory(directory, ignored)) return;
  remove_stale_temporaries(directory);
  remove_files_of_earlier_runs(directory);
  fs::remove(directory / "scenario.effective.json", ignored);
}

RunReport run_scenario(const LoadedScenario& loaded, const std::optional<fs::path>& output, bool progress,
                       RunTables* tables) {
  RunTiming timing;
  const auto shell = [&] {
    const WaitNotice notice(loaded.scenario.name + ": building the shell", progress);
    const auto start = Clock::now();
    auto made = make_shell(loaded.scenario, loaded.files);
    timing.shell = seconds_since(start);
    return made;
  }();
  return run_with_shell(loaded, shell, output, progress, timing, tables);
}

RunReport run_with_shell(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell,
                         const std::optional<fs::path>& output, bool progress, const RunTiming& timing,
                         RunTables* tables) {
  const Scenario& scenario = loaded.scenario;
  RunReport report;
  report.timing = timing;
  const std::vector<Trial> trials = trials_of(scenario);
  NewDirectories directories;
  if (output) create_output(directories, *output);
  if (tables != nullptr) tables->trials.resize(trials.size());

  std::optional<StepTimes> times;
  if (scenario.record.timing) times.emplace(static_cast<std::size_t>(scenario.time.steps) * trials.size());
  std::vector<TrialResult> results;
  for (const Trial trial : trials) {
    TrialOptions options;
    options.files = loaded.files;
    if (output && records_rows(scenario.record)) {
      const fs::path directory = trial_directory(*output, trial, trials.size());
      create_output(directories, directory);
      options.target = directory;
    } else if (tables != nullptr) {
      options.target = &tables->trials[results.size()];
    }
    if (progress) options.label = scenario.name;
    if (progress && trials.size() > 1) options.label += fmt::format(" {}/{}", results.size() + 1, trials.size());
    if (times) options.times = &*times;
    results.push_back(run_trial(scenario, shell, trial, options));
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
