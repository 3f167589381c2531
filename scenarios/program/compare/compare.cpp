#include "scenarios/program/compare/compare.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "algorithms/registry.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/analysis/convergence/finer_runs.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/batch/table_description.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/compare/columns.hpp"
#include "scenarios/program/compare/errors.hpp"
#include "scenarios/program/compare/ranking_text.hpp"
#include "scenarios/program/compare/times.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/replay.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

struct CompareOptions : CommonOptions {
  std::vector<std::string> scenarios, metrics;
  ComparisonQuestion question;  ///< if it has no algorithms, all algorithms are compared
  bool errors = false;
  bool time = false;
  bool full = false;
  std::string replay;  ///< log of a haptic loop that is replayed; empty: the scenarios are simulated
};

/// The name with which --by selects the run time.
constexpr const char* kTimeMetric = "time";

/// Checks the options and plans the comparison. Throws InputError for invalid options or scenarios.
Comparison planned(const CompareOptions& options) {
  require_names("--by", options.metrics, names_of(all_metrics(), &Metric::name), "hapbench describe metrics");
  constexpr double kMaxJitter = 1.0;
  ComparisonQuestion question = options.question;
  if (!(question.jitter >= 0.0 && question.jitter <= kMaxJitter))
    fail_in_option("--jitter", fmt::format("got {}; allowed: 0 ... {} m", question.jitter, kMaxJitter));
  question.scenarios = find_scenarios(options.scenarios);
  question.overrides = options.overrides;
  question.length = options.full ? RunLength::full : RunLength::until_failure;
  question.algorithms = question.algorithms.empty() ? algorithm_names() : chosen_algorithms(question.algorithms);
  return planned(question);
}

/// Returns the metrics that the table of runs shows with --wide.
std::vector<std::string> printed_metrics(const std::vector<Result>& reports) {
  std::vector<std::string> metrics = {kToolVibrationPower};
  for (const RunHeading& heading : kRunHeadings) metrics.emplace_back(heading.metric);
  if (have_reference(reports)) metrics.insert(metrics.end(), kFidelityMetrics, std::end(kFidelityMetrics) - 1);
  return metrics;
}

/// Returns the summaries of all runs. `named` adds the scenario and seed to each summary.
Json summaries_json(const Comparison& comparison, const std::vector<Result>& reports, bool named) {
  Json summaries = Json::array();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    Json& summary = summaries.emplace_back(Json::object());
    if (named) summary = {{"scenario", comparison.names[comparison.scene(i)]}, {"seed", i % comparison.seeds}};
    summary.update(summary_json(reports[i]));
  }
  return summaries;
}

/// Reports runs that diverge although their scenario does not expect this. Does not check the other expectations of a
/// scenario, because they need not hold for every algorithm.
void judge(const Comparison& comparison, const std::vector<Result>& reports, Report& report) {
  constexpr std::size_t kMaxShown = 15;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (reports[i].end.outcome != Outcome::diverges) continue;
    const LoadedScenario loaded = comparison.load(i);
    if (outcome_is_expected(loaded.scenario.expect, Outcome::diverges)) continue;
    const Divergence& d = reports[i].end.divergence;
    texts.push_back(fmt::format("{}: {} diverges at step {}{}", loaded.file.string(), reports[i].algorithm, d.step,
                                d.fault.empty() ? "" : ": " + d.fault));
  }
  for (const std::string& text : first_few(texts, kMaxShown)) report.fault(text, kUnexpectedOutcome);
}

/// Writes comparison.csv of each scene, and prints the warnings about its runs.
void write_runs(const Comparison& comparison, const std::vector<Result>& reports, ProgramContext& context,
                Report& report) {
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const auto of_scene = std::span(reports).subspan(s * comparison.each(), comparison.each());
    print_warnings(context, run_warnings(of_scene));
    std::vector<ComparedRun> runs;
    for (const Result& run : of_scene) runs.push_back({runs.size() % comparison.seeds, run});
    report.write(comparison.scene_folder(s) / "comparison.csv", comparison_columns(comparison.seeds > 1), runs);
  }
}

/// Reports the ranking in ranking.csv, in the printed text and in the JSON.
void report_ranking(const Ranking& ranking, const Layout& layout, Report& report) {
  report.write("ranking.csv", ranking_columns(false), ranking.entries);
  report_ranking_text(ranking, layout, report);
  report.json()["ranking"] = ranking_columns(false).json_list(ranking.entries);
  Json& laws = report.json()["laws"] = law_ranking_columns().json_list(ranking.laws);
  for (std::size_t i = 0; i < laws.size(); ++i) laws[i]["fails"] = ranking.laws[i].fails;
}

/// Reports the table of the runs of one scene. `errors`: true if report_errors() is called afterwards; the sentence on
/// vibration is then omitted.
void report_runs(const std::vector<Result>& reports, const Ranking& ranking, bool errors, const Layout& layout,
                 Report& report) {
  report.add_text(reports.front().name + "\n\n");
  report.show(run_table(reports, false, layout));
  report.add_text(run_legend(reports, layout));
  report_fidelity(reports, layout, report);
  report.add_text(unranked_text(ranking, layout));
  if (!errors) report.add_text(vibration_text(ranking, layout));
  if (layout.in_full()) report.add_text(step_time_text(reports, layout));
}

/// Runs `compare --replay` and returns the exit status. Throws InputError for options that have no meaning with
/// --replay.
int compare_replay(const CompareOptions& options, ProgramContext& context) {
  if (options.errors || options.time || options.full || options.question.seeds != 1 || options.question.jitter != 0.0 ||
      !options.metrics.empty())
    fail_in_option(
        "--replay",
        "got it together with --errors, --time, --full, --seeds, --jitter or --by; allowed: --algorithms, --set, "
        "--out, --json, --quiet");
  if (options.scenarios.size() != 1)
    fail_in_option("--replay", fmt::format("got {} scenarios; allowed: one", options.scenarios.size()));
  const std::vector<std::string> algorithms =
      options.question.algorithms.empty() ? algorithm_names() : chosen_algorithms(options.question.algorithms);
  return compare_replays(options.scenarios[0], options.replay, algorithms, options, context);
}

int compare(const CompareOptions& given, ProgramContext& context) {
  const Layout layout = context.layout();
  // The run time is no metric of a run: it has a table and a ranking of its own.
  CompareOptions options = given;
  options.time |= std::erase(options.metrics, kTimeMetric) > 0;
  if (options.scenarios.empty())
    throw InputError("compare: scenarios is required; \"hapbench compare --help\" explains");
  if (!options.replay.empty()) return compare_replay(options, context);
  // Check all input before anything runs or is written.
  const Comparison comparison = planned(options);
  const bool several = comparison.scenes.size() > 1;
  // True if a ranking is reported: there are several scenes or several seeds, or --by names metrics.
  const bool ranks = several || comparison.seeds > 1 || !options.metrics.empty();
  print_warnings(context, comparison.warnings);
  Report report(options, kCompareFiles, several ? "compare" : "compare_" + comparison.names[0], context);
  const std::filesystem::path& out = report.folder();
  // Prepare the folders of the results. If another command writes to one of them, throw IoError.
  require_unlocked_parents(out, kCompareFiles, 1);
  if (several) require_unlocked(comparison.scene_folders(out), kCompareFiles);
  require_unlocked(comparison.run_folders(out), kRunFiles);
  remove_earlier_comparison(out, comparison);
  for (std::size_t run = 0; run < comparison.size(); ++run)
    require_writable_directory(context, out / comparison.folder(run));
  const JobOptions jobs = job_options(options, "compare", context);
  JobOptions timed = jobs;
  // With --wide, the table of a single scene shows run times, and concurrent runs would slow each other down. Therefore
  // make one run at a time if --jobs is not given.
  if (options.jobs == 0 && !ranks && layout.in_full()) timed.threads = 1;
  const std::vector<Result> reports = run_all(
      comparison.scenes, timed, [&](std::size_t run) { return out / comparison.folder(run); }, comparison.length);
  // Rank the algorithms and write the results of all runs.
  // With --errors, first repeat the runs with finer steps and spacings. These runs give estimates of the errors, and
  // algorithms whose difference is within the errors share a rank.
  std::optional<FinerRuns> finer;
  if (options.errors) finer.emplace(comparison, reports, jobs);
  EstimatedError estimated_error;
  if (finer)
    estimated_error = [&finer](std::size_t run, const std::string& metric) {
      return finer->known_error(run, metric).sum();
    };
  const Ranking ranking =
      rank_comparison(comparison, reports, ranks ? options.metrics : printed_metrics(reports), estimated_error);
  write_runs(comparison, reports, context, report);
  report.json() = summaries_json(comparison, reports, ranks);
  if (ranks || options.errors) report.json() = {{"runs", std::move(report.json())}};
  if (ranks) {
    report_ranking(ranking, layout, report);
  } else {
    report_runs(reports, ranking, options.errors, layout, report);
  }
  for (std::size_t s = 0; finer && s < ranking.scenarios.size(); ++s)
    report_errors(ranking, *finer, s, ranks || layout.in_full(), report, layout);
  if (options.time) report_times(comparison, reports, jobs, layout, report);
  report.add_text(fmt::format("\nresults in {}\n", out.string()));
  judge(comparison, reports, report);
  return report.finish();
}

}  // namespace

void add_compare(CommandLine& line) {
  auto [command, options] = line.command(
      "compare", "Run scenarios with several force laws and show the results side by side, or rank the laws.", compare,
      "the folders of finished runs are kept, but no table is written");
  command.add("scenarios <scenario>...", options.scenarios,
              "scenario files, or names of bundled scenarios or groups (hapbench describe scenarios lists both)");
  add_algorithms(command, options.question.algorithms, "all");
  command.add("--seeds <n>", options.question.seeds,
              "repeat each run n times, with the scenario's seed, seed + 1, and so on (default: 1)",
              {.range = {{1, 10'000}}});
  command.add(
      "--jitter <m>", options.question.jitter,
      "shift the start by this length [m], in one random direction per seed for all laws; without it, all seeds give "
      "the same numbers, unless the scenario contains something random");
  command.add("--by <metric,...>", options.metrics,
              "metrics of the ranking, or time; smaller is better, except for success rates (default: " +
                  fmt::format("{}", fmt::join(kDefaultMetrics, ", ")) +
                  "; if every scenario has a reference force, fidelity metrics instead)",
              {.comma_separated = true});
  add_common(command, options, "compare_NAME; of several scenarios: results/out/compare");
  command.add("--replay <log.csv>", options.replay,
              "render the log of a haptic loop with each law instead of the scenario's motion (scenarios/LOOP.md)");
  command.flag(
      "--errors", options.errors,
      "repeat all runs at half and a quarter of the time step and of the point spacing, to print the error of each "
      "metric and which differences between laws are larger than these errors; about 9 times the work");
  command.flag(
      "--time", options.time,
      "also measure the processor time of a step with each law (smallest of five repetitions, without metrics and "
      "files, one run at a time), and rank the laws by it (like --by time); writes comparison_timing.csv");
  add_table(command, options.output);
  command.flag("--full", options.full,
               "make all steps of runs that otherwise end early and have empty metrics (see Failed run)");
  command.footer(
      "Ranking: printed for several scenarios, for several seeds, or with --by. The rank of a law is 1 + the number of "
      "better laws. A law is better if its mean is better by more than 0.1 % and by more than the errors of both means "
      "together. The errors follow from the metrics' definitions. The spread over seeds does not count. Laws with a "
      "failed run rank last.\n\n"
      "Other comparisons: compare varies only the law. \"hapbench sweep\" runs a scenario with several values of any "
      "field, such as two stiffnesses.\n\n"
      "Failed run: it diverges, passes through the surface, loses contact or never touches, sticks, does not follow "
      "the drag of its hand, or does not end as its scenario expects. A run that diverges, passes through the surface "
      "or leaves it permanently ends early, at this moment, and its metrics are empty (hapbench describe \"early "
      "end\").\n\n"
      "Files: comparison.csv (one row per run), ranking.csv (one row per scenario, law and metric), and each run in "
      "OUT/[SCENARIO/]ALGORITHM[/seed_K], with SCENARIO for several scenarios and seed_K for several seeds. An earlier "
      "comparison of the same scenarios in the folder is removed, other files stay.\n\n"
      "Exit status: 3 if a run diverges and its scenario does not expect that; otherwise 0, also if laws fail in "
      "another way; 2 bad input.");
}

}  // namespace hapbench
