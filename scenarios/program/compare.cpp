#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "algorithms/registry.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/result_folders.hpp"
#include "scenarios/batch/run_batch.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/compare_errors.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/studies/stability/judged_run.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  std::vector<std::string> metrics;
  unsigned seeds = 1;
  double jitter = 0.0;
  bool html = false;
  bool errors = false;
  Skips skips = Skips::on;
  std::vector<std::string> scenarios;
  std::vector<std::string> algorithms;  ///< empty: all
  std::vector<std::string> overrides;
  unsigned jobs = 0;
  std::string out;
  OutputOptions output;
};

/// True when there are several scenarios or seeds to rank over, or metrics to rank by.
bool wants_league(const CompareOptions& options, const BatchPlan& plan) {
  return plan.scenarios.size() > 1 || options.seeds > 1 || !options.metrics.empty();
}

BatchPlan plan_of(const CompareOptions& options) {
  if (!options.metrics.empty()) require_names("--by: got", options.metrics, metric_names());
  constexpr double kMostJitter = 1.0;
  if (!(options.jitter >= 0.0 && options.jitter <= kMostJitter)) {
    throw InputError(fmt::format("--jitter: got {}; allowed: 0 ... {} m", options.jitter, kMostJitter));
  }
  BatchDefinition definition;
  const std::vector<std::string>& algorithms = options.algorithms;
  definition.algorithms =
      algorithms.empty() ? all_algorithms() : chosen_names("--algorithms: got", algorithms, all_algorithms());
  definition.scenarios = find_scenarios(options.scenarios);
  definition.overrides = options.overrides;
  definition.seeds = options.seeds;
  definition.jitter = options.jitter;
  definition.skips = options.skips;
  return plan_batch(std::move(definition));
}

fs::path directory_of(const CompareOptions& options, const BatchPlan& plan) {
  return results_directory(options.out, plan.names.size() > 1 ? "compare" : "compare_" + plan.names[0]);
}

/// Makes the directories and removes the results of an earlier comparison from them.
void prepare(const fs::path& out, const BatchPlan& plan, bool league) {
  ResultList results;
  for (std::size_t i = 0; i < plan.size(); ++i) results.runs.push_back(run_directory(plan, i));
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    results.tables.push_back(scenario_directory(plan, s) / "comparison.csv");
  }
  if (league) results.tables.emplace_back("league.csv");
  for (const fs::path& run : results.runs) require_writable_directory(out / run);
  replace_earlier_results(out, results);
}

double expected_bytes(const BatchPlan& plan) {
  const std::size_t each = plan.size() / plan.scenarios.size();
  double bytes = 0.0;
  for (std::size_t i = 0; i < plan.size(); i += each)
    bytes += static_cast<double>(each) * expected_output_bytes(scenario_of(plan, i).scenario);
  return bytes;
}

/// The metrics of the league, or without one those of the printed table.
std::vector<std::string> compared(const CompareOptions& options, const BatchPlan& plan, const BatchReport& report) {
  if (wants_league(options, plan)) return options.metrics;
  std::vector<std::string> metrics = compared_metrics();
  if (have_reference(report.runs)) metrics.insert(metrics.end(), kFidelityMetrics, std::end(kFidelityMetrics) - 1);
  return metrics;
}

BatchOptions batch_options(const CompareOptions& options, const BatchPlan& plan, const fs::path& out) {
  BatchOptions batch;
  batch.directory = out;
  // The table of a single comparison shows times, which concurrent runs would lengthen.
  batch.jobs = options.jobs > 0 ? options.jobs : wants_league(options, plan) ? available_threads() : 1;
  batch.progress = !options.output.quiet;
  return batch;
}

/// The reports of one scenario.
std::span<const RunReport> reports_of(const BatchPlan& plan, const BatchReport& report, std::size_t scenario) {
  const std::size_t each = plan.size() / plan.scenarios.size();
  return std::span(report.runs).subspan(scenario * each, each);
}

/// The tables of one scenario's runs.
std::string comparison_text(std::span<const RunReport> reports) {
  RunTable table({"algorithm"});
  for (const RunReport& report : reports) table.add({report.summary.algorithm}, report);
  return fmt::format("{}\n\n{}{}{}{}", reports.front().summary.name, table.text(), fidelity_text(reports),
                     unsettled_text(reports), step_time_text(reports));
}

/// Names the algorithms of a single scenario whose definition fixes a depth model, if others use another one. Each of
/// their runs would warn of it.
std::string own_depth_models_text(const BatchPlan& plan) {
  std::vector<std::string> own;
  std::set<std::string> models;
  for (std::size_t i = 0; i < plan.size(); i += plan.definition.seeds) {
    const Scenario scenario = scenario_of(plan, i).scenario;
    if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return "";
    const RenderingConfig& rendering = scenario.rendering;
    models.insert(rendering.depth_model);
    if (!find_algorithm(rendering.algorithm)->fixed_depth_model.empty())
      own.push_back(fmt::format("{} with {}", rendering.algorithm, rendering.depth_model));
  }
  if (models.size() < 2) return "";
  return wrapped(fmt::format("defined with a depth model of their own: {}", fmt::join(own, ", ")), 0);
}

/// "A" ... "Z", "AA", "AB", ...: short names for scenarios.
std::string letter(std::size_t scenario) {
  const std::string last(1, static_cast<char>('A' + scenario % 26));
  return scenario < 26 ? last : letter(scenario / 26 - 1) + last;
}

std::string letters(const std::vector<std::size_t>& scenarios) {
  std::vector<std::string> texts;
  for (const std::size_t scenario : scenarios) texts.push_back(letter(scenario));
  return fmt::format("{}", fmt::join(texts, " "));
}

/// The columns of a scenario in a table of standings: the rank, or also mean and spread.
enum class Detail { rank, spread };

std::vector<Table::Column> standing_columns(std::size_t scenarios, Detail detail) {
  std::vector<Table::Column> columns = {{"algorithm", false}};
  for (std::size_t s = 0; s < scenarios; ++s) {
    columns.push_back({scenarios > 1 ? letter(s) + " " : "rank ", true,
                       scenarios > 1
                           ? "of compare: rank in the scenario that has this letter above the table; x: a run failed"
                           : "rank"});
    if (detail == Detail::spread) columns.insert(columns.end(), {{"mean", true, "mean"}, {"spread", true, "spread"}});
  }
  return columns;
}

/// By how much the mean may be wrong: by what its numbers may be, or by what another choice of seeds gives.
std::optional<double> mean_error(const League& league, std::size_t scenario, const Standing& standing) {
  if (!standing.spread) return standing.tolerance;
  const double of_seeds = *standing.spread / std::sqrt(static_cast<double>(league.common[scenario].size()));
  return std::max(standing.tolerance, std::optional(of_seeds));
}

Table standings(const League& league, std::size_t metric, Detail detail) {
  Table table(standing_columns(league.runs.scenarios.size(), detail));
  for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
    std::vector<std::string> cells = {league.runs.algorithms[a]};
    for (std::size_t s = 0; s < league.runs.scenarios.size(); ++s) {
      const Standing& standing = league.at(s, a, metric);
      cells.push_back(standing.rank ? fmt::format("{}{}", *standing.rank, league.failures(s, a) > 0 ? 'x' : ' ')
                                    : "- ");
      if (detail == Detail::rank) continue;
      cells.push_back(standing.mean ? deserved(*standing.mean, mean_error(league, s, standing)) : "-");
      cells.push_back(significant(standing.spread, 2));
    }
    table.add(std::move(cells));
  }
  return table;
}

std::string standings_text(const League& league, std::size_t metric) {
  const Table table = standings(league, metric, Detail::spread);
  return table.width() <= prose_width() ? table.text() : standings(league, metric, Detail::rank).text(prose_width());
}

std::vector<Table::Column> law_columns() {
  return {
      {"algorithm", false},
      {"mean rank", true, "mean of the algorithm's ranks over all metrics and scenarios, with those after failures"},
      {"fails", false, "letters of the scenarios in which a run failed"}};
}

std::string laws_text(const League& league) {
  Table table(law_columns());
  for (const LawStanding& law : league.laws)
    table.add({league.runs.algorithms[law.algorithm], significant(law.mean_rank, 3), letters(law.fails)});
  return table.text();
}

/// Says where no spread is known, and why.
std::string spread_text(const League& league) {
  if (league.runs.seeds < 2) return "one seed: no spread is known; --seeds K gives one\n";
  std::vector<std::size_t> alike;
  for (std::size_t s = 0; s < league.seeds_matter.size(); ++s) {
    if (!league.seeds_matter[s]) alike.push_back(s);
  }
  const std::string random = "\"hapbench report\" says what lies between laws, seed by seed\n";
  return alike.empty() ? random
                       : fmt::format(
                             "nothing is random in {}: all seeds are one run, no spread is known; --jitter METRES "
                             "shifts the start\n",
                             letters(alike));
}

/// Names the seeds that the means are over, in a scenario in which some runs failed.
std::string failed_seeds_text(const League& league, std::size_t scenario) {
  const std::size_t seeds = league.runs.seeds, common = league.common[scenario].size();
  std::vector<std::string> failed;
  for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
    const std::size_t failures = league.failures(scenario, a);
    if (failures > 0 && failures < seeds) failed.push_back(fmt::format("{} {}", league.runs.algorithms[a], failures));
  }
  if (failed.empty()) return "";
  return fmt::format("\n   means over {} of {} seeds; failed: {}", common, seeds, fmt::join(failed, ", "));
}

/// For each metric a table of algorithms and scenarios, with rank, mean and spread as far as they fit into kTableWidth,
/// then a line for each algorithm.
std::string league_text(const League& league) {
  std::string text;
  const std::size_t scenarios = league.runs.scenarios.size();
  for (std::size_t s = 0; s < scenarios; ++s)
    text += fmt::format("{}  {}{}\n", letter(s), league.runs.scenarios[s], failed_seeds_text(league, s));
  for (std::size_t m = 0; m < league.runs.metrics.size(); ++m) {
    const Better better = league.runs.better[m];
    text += fmt::format("\n{}, {}\n\n{}", league.runs.metrics[m],
                        better == Better::less   ? "less is better"
                        : better == Better::more ? "more is better"
                                                 : "neither less nor more is better: not ranked",
                        standings_text(league, m));
  }
  return text + fmt::format(
                    "\nall metrics and scenarios\n\n{}\n"
                    "Means closer than {} % share a rank. x: a run failed; it ranks behind all that did not, by the\n"
                    "number of failures; of the others those without such a number are last.\n{}",
                    laws_text(league), 100.0 * kSameRank, spread_text(league));
}

Json summaries_json(const BatchPlan& plan, const BatchReport& report, bool league) {
  Json summaries = Json::array();
  for (std::size_t i = 0; i < plan.size(); ++i) {
    Json summary = summary_json(report.runs[i].summary);
    if (league) {
      const BatchRun run = plan.run(i);
      Json named = {{"scenario", plan.names[run.scenario]}, {"seed", run.seed}};
      named.update(summary);
      summary = std::move(named);
    }
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

/// Reports runs that diverge although their scenario does not expect it, the only expectation that concerns every
/// algorithm: all of a single comparison, the first of a batch. Returns the exit status.
int verdict(const BatchPlan& plan, const BatchReport& report, bool league) {
  std::size_t count = 0;
  std::string first;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const RunSummary& summary = report.runs[i].summary;
    const BatchRun run = plan.run(i);
    if (summary.result.outcome != Outcome::diverges ||
        outcome_is_expected(scenario_of(plan, i).scenario.expect, Outcome::diverges)) {
      continue;
    }
    const Divergence& d = summary.result.divergence;
    const std::string text = fmt::format("{}: {} diverges at step {}{}", plan.scenarios[run.scenario].file.string(),
                                         summary.algorithm, d.step, d.fault.empty() ? "" : ": " + d.fault);
    if (!league) print_error(text);
    if (count++ == 0) first = text;
  }
  if (league && count > 0) {
    print_error(fmt::format("{} of {} runs diverge, the first: {}", count, plan.size(), first));
  }
  return count > 0 ? kUnexpectedOutcome : kSuccess;
}

int compare(const CompareOptions& options) {
  if (options.scenarios.empty())
    throw InputError("compare: scenarios is required; \"hapbench compare --help\" explains");
  // All input is checked before anything runs or is written.
  const BatchPlan plan = plan_of(options);
  const fs::path out = directory_of(options, plan);
  print_warnings(plan.warnings);
  prepare(out, plan, wants_league(options, plan));
  announce_large_output(expected_bytes(plan));

  std::optional<ComparedErrors> errors;
  const BatchReport report = [&] {
    try {
      BatchReport runs = run_batch(plan, batch_options(options, plan, out));
      BatchOptions batch = batch_options(options, plan, out);
      if (options.jobs == 0) batch.jobs = available_threads();
      if (options.errors) errors = errors_of(plan, runs, compared(options, plan, runs), batch);
      return runs;
    } catch (const Stopped&) {
      forget_results_if_none(out);
      throw;
    }
  }();
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    print_warnings(run_warnings(reports_of(plan, report, s)));
    write_comparison(out / scenario_directory(plan, s) / "comparison.csv", reports_of(plan, report, s), options.seeds);
  }
  std::string last = fmt::format("\nresults in {}\n", out.string());
  if (errors) last = errors->text + last;
  Json json = summaries_json(plan, report, wants_league(options, plan));
  if (wants_league(options, plan)) {
    const League league = make_league(league_runs(plan, report, options.metrics));
    write_league(out / "league.csv", league);
    Json batch = {{"runs", std::move(json)}};
    batch.update(league_json(league));
    if (errors) batch["errors"] = std::move(errors->json);
    print(options.output, league_text(league) + last, batch);
  } else {
    if (errors) json = {{"runs", std::move(json)}, {"errors", std::move(errors->json)}};
    print(options.output, comparison_text(report.runs) + own_depth_models_text(plan) + last, json);
  }
  if (options.html) write_report(out, options.output.quiet || options.output.json);
  return verdict(plan, report, wants_league(options, plan));
}

}  // namespace

std::vector<Table::Column> league_headings() {
  return joined_headings({standing_columns(26, Detail::rank), standing_columns(1, Detail::spread), law_columns()});
}

void add_compare(CommandLine& line) {
  auto [command, options] =
      line.command("compare", "Run scenarios through several algorithms side by side; several scenarios give a league",
                   compare, "the folders of finished runs are kept, but no table is written");
  command.add("scenarios", options.scenarios, "scenario files, names of bundled scenarios, or of groups of them");
  command.add("--algorithms", options.algorithms, "names, separated by commas, or all (default: all)")
      .comma_separated();
  command.add("--seeds", options.seeds, "run each K times, time k with the scenario's seed + k (default: 1)")
      .range(1, 10'000);
  command.add(
      "--jitter", options.jitter,
      "shift the start by a vector of this length [m] whose direction depends on the seed and is the same for all "
      "algorithms: gives a spread where nothing else is random");
  command
      .add("--by", options.metrics,
           "metrics of the league, less is better: names of summary.json, separated by commas (default: " +
               default_metrics_text() + "; fidelity where every scene has a reference force)")
      .comma_separated();
  add_jobs(command, options.jobs, "runs at once (default: one per thread; 1 where the table shows times)");
  command.add(
      "--out", options.out,
      "directory of the results (default: results/out/compare_NAME, for several scenarios results/out/compare)");
  add_overrides(command, options.overrides);
  command.flag("--html", options.html, "also write OUT/report.html: curves, replay, metrics, commands");
  command.flag("--errors", options.errors,
               "also run each at half and a quarter of the step and of the distance of the shell's points, and say of "
               "each metric how far that moves it and which laws' order holds");
  add_skip_option(command, options.skips);
  add_output_options(command, options.output);
  command.footer(
      "Files go to OUT/[SCENARIO/]ALGORITHM[/seed_K], the parts in brackets where there are several, and "
      "comparison.csv of each scenario beside them. Several scenarios or seeds, or --by, give a league: rank, mean and "
      "spread over the seeds, and where each algorithm fails; league.csv has all of it. A run fails when it diverges, has no contact or loses it, goes through the "
      "surface, is not dragged or stuck, or "
      "ends otherwise than its scenario allows; it ranks behind all others. The results of an earlier comparison in OUT "
      "are removed, other files are not.");
}

}  // namespace hapbench
