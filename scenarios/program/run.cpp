#include "scenarios/program/run.hpp"

#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "results/observe/target_metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/replay.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct RunOptions : CommonOptions {
  std::vector<std::string> scenarios;
  std::string replay;  ///< log of a haptic loop that is replayed; empty: the scenario is simulated
  bool latency = false, no_skip = false;
};

/// Returns a directory for each scenario. A single scenario writes to the folder of --out, several scenarios to
/// subdirectories of it that are named after their files. Without --out, each scenario writes to a subdirectory of
/// results/out that is named after its file. Throws InputError if two files have the same name.
std::vector<fs::path> output_directories(const std::string& out, const std::vector<fs::path>& files) {
  std::vector<fs::path> directories;
  for (const std::string& name : names_of_scenarios(files)) {
    const fs::path directory = results_directory(out, name);
    directories.push_back(out.empty() || files.size() == 1 ? directory : directory / name);
  }
  return directories;
}

/// Returns the columns of the table of section D.4 of the thesis: means over subjects for each target.
Columns<PositionMetrics> target_columns() {
  const auto mean = [](SubjectMean PositionMetrics::*of, double factor = 1.0) {
    return [=](const PositionMetrics& p) {
      const SubjectMean& m = p.*of;
      if (m.subjects == 0) return std::string("-");
      return with_spread(factor * m.mean, factor * m.standard_error, std::nullopt, 3);
    };
  };
  return {{"place", "1", "index of the target position, from 0", &PositionMetrics::position, only_printed()},
          {"success rate", "1", "targets.0.success_rate.mean", mean(&PositionMetrics::success_rate), only_printed()},
          {"completion [s]", "1", "targets.0.completion_time_s.mean", mean(&PositionMetrics::completion_time),
           only_printed()},
          {"model force [N]", "1", "targets.0.model_force_N.mean", mean(&PositionMetrics::model_force), only_printed()},
          {"speed [mm/s]", "1", "targets.0.speed_m_per_s.mean", mean(&PositionMetrics::speed, 1e3), only_printed()}};
}

/// Returns the columns of the table of step times, which --latency prints.
Columns<Result> latency_columns() {
  const auto time = [](std::uint64_t StepLatency::*of) {
    return [of](const Result& r) {
      const StepLatency& latency = *r.timing.latency;
      return latency.steps > 0 ? short_text(static_cast<double>(latency.*of), std::nullopt, 1e-3) : "-";
    };
  };
  Columns<Result> columns = {
      {"step latency", "", "of run --latency: scenario whose steps were timed", &Result::name, only_printed()},
      {"steps", "1", "", [](const Result& r) { return r.timing.latency->steps; }, only_printed()}};
  for (const auto& [part, of] : {std::pair{"50", &StepLatency::p50},
                                 {"95", &StepLatency::p95},
                                 {"99", &StepLatency::p99},
                                 {"99.9", &StepLatency::p99_9}}) {
    columns.add({{fmt::format("p{} us", part), "us",
                  fmt::format("{} % of the time steps take at most this wall time each [us]", part), time(of),
                  only_printed()}});
  }
  columns.add({{"max us", "us", "wall time of the longest time step [us]", time(&StepLatency::max), only_printed()}});
  for (std::size_t i = 0; i < std::size(kStepDeadlines); ++i) {
    columns.add({{fmt::format("> {:.3f} ms", 1e3 * kStepDeadlines[i]), "1",
                  "number of time steps that took longer than this deadline",
                  [i](const Result& r) { return r.timing.latency->misses[i]; }, only_printed()}});
  }
  columns.add({{"clock us", "us", "wall time of reading the clock, which is included in each step's time [us]",
                time(&StepLatency::overhead), only_printed()}});
  return columns;
}

/// Returns the diagnosis of runs as text; empty if no run exceeds the threshold of a rule. For a single run, the text
/// explains each rule whose threshold is exceeded, and adds advice. For several runs, the text has one line for each
/// run that exceeds a threshold, with the names, values and thresholds of the rules.
std::string diagnosis_text(std::span<const Result> reports, const Layout& layout) {
  std::string text;
  const bool several = reports.size() > 1;
  for (const Result& report : reports) {
    std::vector<std::string> rules;
    // Explain each rule for a single run. For several runs, only print the rule with its value and threshold.
    for (const Diagnosed& found : *report.diagnosis) {
      const std::string numbers = value_and_threshold_text(found);
      rules.push_back(fmt::format("{} ({})", found.rule, numbers));
      if (several) continue;
      text += layout.wrapped(fmt::format("{} (rule {}: {})", found.says, found.rule, numbers), 0);
      text += layout.wrapped("try: " + found.attempt, 2);
    }
    if (several && !rules.empty())
      text += layout.wrapped(fmt::format("diagnosis of {}: {}", report.name, fmt::join(rules, ", ")), 0);
  }
  if (text.empty()) return "";
  if (several) text += "run one scenario alone to get advice; \"hapbench describe diagnosis\" explains the rules\n";
  return "\n" + text;
}

/// Returns a text that says where the scenario's expectations come from: from the field `expect`, or from the default
/// of this field.
const char* expectation_source(const Scenario& scenario) {
  const bool is_default = scenario.expect.outcomes == ExpectFields{}.outcomes && scenario.expect.metrics.empty();
  return is_default ? "by default, without the field expect" : "field expect";
}

/// Reports the tables and the diagnosis of the runs.
void report_results(const std::vector<Result>& results, bool latency, const Layout& layout, Report& report) {
  report.show(run_table(results, true, layout));
  report.add_text(run_legend(results, layout));
  report.add_text(step_time_text(results, layout));
  report_fidelity(results, layout, report);
  for (const Result& result : results) {
    if (!result.sections.contains("targets")) continue;
    const std::string caption = fmt::format("{}: targets, mean +- standard error over subjects", result.name);
    report.add_text(fmt::format("\n{}\n\n", caption));
    report.show(target_columns().table(position_metrics(result.targets), caption, layout.in_full()));
  }
  if (latency) {
    report.add_text("\n");
    report.show(latency_columns().table(results, "wall time of the time steps", layout.in_full()));
  }
  report.add_text(diagnosis_text(results, layout));
}

/// Runs `run --replay` and returns the exit status. Throws InputError for options that have no meaning with --replay.
int run_replay(const RunOptions& options, ProgramContext& context) {
  if (options.latency || options.no_skip)
    fail_in_option("--replay", "got it together with --latency or --no-skip; allowed: --set, --out, --json, --quiet");
  if (options.scenarios.size() != 1)
    fail_in_option("--replay", fmt::format("got {} scenarios; allowed: one", options.scenarios.size()));
  return replay_loop(options.scenarios[0], options.replay, options, context);
}

int run(const RunOptions& options, ProgramContext& context) {
  if (!options.replay.empty()) return run_replay(options, context);
  const Layout layout = context.layout();
  // Check all input before anything runs or is written.
  std::vector<std::string> overrides = options.overrides;
  if (options.latency) overrides.emplace_back("record.timing=true");
  std::vector<LoadedScenario> loaded;
  const std::vector<fs::path> files = find_scenarios(options.scenarios);
  for (const fs::path& file : files) loaded.push_back(load_scenario(file, overrides));
  const std::vector<fs::path> directories = output_directories(options.out, files);
  std::vector<CheckedScenario> scenarios;
  for (LoadedScenario& scene : loaded) {
    if (options.no_skip) scene.scenario.rendering.skips = Skips::off;
    scenarios.push_back(checked(std::move(scene)));
    print_warnings(context, scenarios.back());
  }
  std::vector<FolderLock> locks;
  for (const fs::path& directory : directories) locks.push_back(locked_run(context, directory));

  // Run the scenarios one after the other.
  const fs::path where = directories.size() == 1 ? directories[0] : directories[0].parent_path();
  Report report(options.output, where, context);
  std::vector<Result> results;
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    const Result& result =
        results.emplace_back(run_scenario(scenarios[i], RunOutput(directories[i], /*has_lock=*/true),
                                          {!options.output.quiet, context.progress}, nullptr, Diagnose::everything));
    // Tell users who try values of a field that the results of the previous value were replaced.
    if (result.replaces_other && options.out.empty() && !options.overrides.empty())
      print_note(context,
                 fmt::format("replaced the results of a run with other fields in {}; --out DIRECTORY keeps both",
                             directories[i].string()));
    print_warnings(context, run_warnings({&result, 1}));
    Json& summary = report.json().emplace_back(summary_json(result));
    if (options.latency) summary["step_latency"] = step_latency_json(*result.timing.latency);
    for (const std::string& unmet : result.unmet) {
      report.fault(fmt::format(R"({}: {} ({}; --set 'expect={{"outcome":"{}"}}' accepts this outcome))",
                               scenarios[i].loaded().file.string(), unmet, expectation_source(scenarios[i].scenario()),
                               outcome_name(result.end.outcome)),
                   kUnexpectedOutcome);
    }
  }
  report_results(results, options.latency, layout, report);
  report.add_text(fmt::format("\nresults in {}\n", where.string()));
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> single_run_tables() {
  return {target_columns().described(), latency_columns().described()};
}

void add_run(CommandLine& line) {
  auto [command, options] =
      line.command("run", "Run scenarios, write their results, and diagnose problems such as vibration.", run,
                   "nothing of the unfinished run is written; finished runs are kept");
  command.add("scenarios <scenario>...", options.scenarios,
              "scenario files, or names of bundled scenarios or groups (hapbench describe scenarios lists both)",
              {.required = true});
  command.add(
      "--out <dir>", options.out,
      "folder of the results (default: results/out/NAME, NAME of the scenario's file); several scenarios write to "
      "DIR/NAME");
  add_overrides(command, options.overrides);
  command.add("--replay <log.csv>", options.replay,
              "render the log of a haptic loop (scenarios/LOOP.md) instead of the scenario's motion, and compare every "
              "output with the recorded output");
  command.flag(
      "--latency", options.latency,
      "measure the time of every step; print percentiles, and the numbers of steps longer than 0.5 ms and than "
      "1/2048 s");
  add_table(command, options.output);
  command.flag("--no-skip", options.no_skip,
               "disable all shortcuts of the computation, for checks; results are the same, but the run takes longer");
  command.footer(
      "Files: trajectory.csv (pose, velocity and forces at every step), summary.json (outcome, metrics, warnings, "
      "diagnosis), scenario.effective.json (all fields; repeats the run), columns.json (units and meanings). "
      "\"hapbench plot FOLDER\" draws them. With --set record.contacts=true also contacts.csv (depth and force of "
      "every contact point).\n\n"
      "Diagnosis: each rule that applies is printed with its value, its threshold and what to try, and is also in "
      "summary.json. For several scenarios, only the rules with their values and thresholds are printed.\n\n"
      "Expectations: without the field expect, the outcomes completes, leaves_hole and tool_horizontal are expected. "
      "If a --set changes the run, these three outcomes are accepted too, and the bounds on metrics in expect are not "
      "checked.\n\n"
      "Earlier results: all files of an earlier run in the same folder are replaced; other files stay. To keep both "
      "runs, give the new run another --out.\n\n"
      "Replay: give the scenario with which the log was recorded. With another scenario the forces may differ; a note "
      "then reports this. The new outputs are in results/out/NAME_replay/replay.csv, a log like the recorded one.\n\n"
      "Exit status: 3 if a run does not end as its scenario expects, or if a replay with the scenario of the recording "
      "gives other outputs; the results are written in any case.");
}

}  // namespace hapbench
