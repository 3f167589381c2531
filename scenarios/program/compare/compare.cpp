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
#include "scenarios/program/compare/league_text.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

struct CompareOptions : CommonOptions {
  std::vector<std::string> scenarios, metrics;
  ComparisonQuestion question;  ///< without algorithms: all
  bool errors = false;
};

Comparison planned(const CompareOptions& options) {
  require_names("--by: got", options.metrics, names_of(all_metrics(), &Metric::name), "hapbench describe metrics");
  constexpr double kMostJitter = 1.0;
  ComparisonQuestion question = options.question;
  if (!(question.jitter >= 0.0 && question.jitter <= kMostJitter))
    throw InputError(fmt::format("--jitter: got {}; allowed: 0 ... {} m", question.jitter, kMostJitter));
  question.scenarios = find_scenarios(options.scenarios);
  question.overrides = options.overrides;
  question.algorithms = question.algorithms.empty() ? algorithm_names() : chosen_algorithms(question.algorithms);
  return planned(question);
}

/// The metrics of the table with --wide.
std::vector<std::string> printed_metrics(const std::vector<Result>& reports) {
  std::vector<std::string> metrics = {kToolVibrationPower};
  for (const RunHeading& heading : kRunHeadings) metrics.emplace_back(heading.metric);
  if (have_reference(reports)) metrics.insert(metrics.end(), kFidelityMetrics, std::end(kFidelityMetrics) - 1);
  return metrics;
}

/// `named`: with scenario and seed.
Json summaries_json(const Comparison& comparison, const std::vector<Result>& reports, bool named) {
  Json summaries = Json::array();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    Json& summary = summaries.emplace_back(Json::object());
    if (named) summary = {{"scenario", comparison.names[comparison.scene(i)]}, {"seed", i % comparison.seeds}};
    summary.update(summary_json(reports[i]));
  }
  return summaries;
}

/// Reports runs that diverge unexpectedly; no other expectation of a scenario concerns every algorithm.
void judge(const Comparison& comparison, const std::vector<Result>& reports, Report& report) {
  constexpr std::size_t kMostShown = 15;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (reports[i].end.outcome != Outcome::diverges) continue;
    const LoadedScenario loaded = comparison.load(i);
    if (outcome_is_expected(loaded.scenario.expect, Outcome::diverges)) continue;
    const Divergence& d = reports[i].end.divergence;
    texts.push_back(fmt::format("{}: {} diverges at step {}{}", loaded.file.string(), reports[i].algorithm, d.step,
                                d.fault.empty() ? "" : ": " + d.fault));
  }
  for (const std::string& text : first_few(texts, kMostShown)) report.fault(text, kUnexpectedOutcome);
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

void report_league(const League& league, const Layout& layout, Report& report) {
  report.write("league.csv", league_columns(false), league.standings);
  report.say(league_text(league, layout));
  report.json()["standings"] = league_columns(false).json_list(league.standings);
  Json& laws = report.json()["laws"] = law_columns().json_list(league.laws);
  for (std::size_t i = 0; i < laws.size(); ++i) laws[i]["fails"] = league.laws[i].fails;
}

/// The table of the runs of one scene; `errors`: how sure its numbers are is said elsewhere.
std::string runs_text(const std::vector<Result>& reports, const League& league, bool errors, const Layout& layout) {
  std::string text = reports.front().name + "\n\n" + run_table(reports, false, layout) + fidelity_text(reports, layout);
  if (!errors) text += vibration_text(league, layout);
  if (layout.in_full()) text += step_time_text(reports, layout);
  return text;
}

int compare(const CompareOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  if (options.scenarios.empty())
    throw InputError("compare: scenarios is required; \"hapbench compare --help\" explains");
  // All input is checked before anything runs or is written.
  const Comparison comparison = planned(options);
  const bool several = comparison.scenes.size() > 1;
  // Whether there is something to rank over, or metrics to rank by.
  const bool ranks = several || comparison.seeds > 1 || !options.metrics.empty();
  print_warnings(context, comparison.warnings);
  Report report(options, several ? "compare" : "compare_" + comparison.names[0], context);
  const std::filesystem::path& out = report.folder();
  remove_earlier_comparison(out, comparison);
  for (std::size_t run = 0; run < comparison.size(); ++run)
    require_writable_directory(context, out / comparison.folder(run));
  const JobOptions jobs = job_options(options, "compare");
  JobOptions timed = jobs;
  // The wide table of a single comparison shows times, which concurrent runs would lengthen.
  if (options.jobs == 0 && !ranks && layout.in_full()) timed.threads = 1;
  const std::vector<Result> reports =
      run_all(comparison.scenes, timed, [&](std::size_t run) { return out / comparison.folder(run); });
  const League league = league_of(comparison, reports, ranks ? options.metrics : printed_metrics(reports));
  write_runs(comparison, reports, context, report);
  report.json() = summaries_json(comparison, reports, ranks);
  if (ranks || options.errors) report.json() = {{"runs", std::move(report.json())}};
  if (ranks) {
    report_league(league, layout, report);
  } else {
    report.say(runs_text(reports, league, options.errors, layout));
  }
  if (options.errors) {
    const FinerRuns finer(comparison, reports, jobs);
    for (std::size_t s = 0; s < league.scenarios.size(); ++s)
      report_errors(league, finer, s, ranks || layout.in_full(), report, layout);
    report.say("\n" +
               layout.wrapped(
                   "<: smaller by more than the sum of both errors; ~: not distinguishable; ?: a finer run has another "
                   "outcome, so that no error is known",
                   0));
  }
  report.say(fmt::format("\nresults in {}\n", out.string()));
  judge(comparison, reports, report);
  return report.finish();
}

}  // namespace

void add_compare(CommandLine& line) {
  auto [command, options] =
      line.command("compare", "Run scenarios through several algorithms side by side; several scenarios give a league",
                   compare, "the folders of finished runs are kept, but no table is written");
  command.add("scenarios", options.scenarios, "scenario files, names of bundled scenarios, or of groups of them");
  add_algorithms(command, options.question.algorithms, "all");
  command.add("--seeds", options.question.seeds, "run each K times, time k with the scenario's seed + k (default: 1)",
              {.range = {{1, 10'000}}});
  command.add(
      "--jitter", options.question.jitter,
      "shift the start by a vector of this length [m] whose direction depends on the seed and is the same for all "
      "algorithms: gives a spread where nothing else is random");
  command.add("--by", options.metrics,
              "metrics of the league, less is better: names of summary.json, separated by commas (default: " +
                  fmt::format("{}", fmt::join(kDefaultMetrics, ",")) +
                  "; fidelity where every scene has a reference force)",
              {.comma_separated = true});
  add_common(command, options, "compare_NAME, of several scenarios results/out/compare");
  command.flag("--errors", options.errors,
               "also run each at half and a quarter of the step and of the distance of the shell's points, and say of "
               "each metric how far that moves it and which laws' order holds");
  command.footer(
      "Files go to OUT/[SCENARIO/]ALGORITHM[/seed_K], the parts in brackets where there are several, and "
      "comparison.csv of each scenario beside them. Several scenarios or seeds, or --by, give a league: rank, mean "
      "and spread over the seeds, and where each algorithm fails; league.csv has all of it. A run fails when it "
      "diverges, has no contact or loses it, goes through the surface, is not dragged or stuck, or ends otherwise "
      "than its scenario allows; it ranks behind all others. The results of an earlier comparison in OUT are "
      "removed, other files are not.");
}

}  // namespace hapbench
