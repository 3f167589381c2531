#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <span>

#include "algorithms/registry.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/studies/convergence/convergence.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// ---- The tables of a league

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

/// By how much the mean may be wrong: by what its numbers may be, or by what another choice of seeds gives.
std::optional<double> mean_error(const Standing& standing) {
  if (!standing.spread) return standing.tolerance;
  const double of_seeds = *standing.spread / std::sqrt(static_cast<double>(standing.common_seeds));
  return std::max(standing.tolerance, std::optional(of_seeds));
}

std::string rank_text(const Standing& standing) {
  return standing.rank ? fmt::format("{}{}", *standing.rank, standing.failed > 0 ? 'x' : ' ') : "- ";
}

std::string mean_text(const Standing& standing) {
  return standing.mean ? deserved(*standing.mean, mean_error(standing)) : "-";
}

/// A row is the standings of an algorithm by one metric in each scenario.
using StandingsRow = std::vector<const Standing*>;

/// `with_spread`: also mean and spread of each scenario.
Columns<StandingsRow> standings_columns(std::size_t scenarios, bool with_spread) {
  Columns<StandingsRow> columns;
  columns.print("algorithm", "", "", [](const StandingsRow& r) { return r[0]->algorithm; });
  for (std::size_t s = 0; s < scenarios; ++s) {
    columns.print(scenarios > 1 ? letter(s) + " " : "rank ", "1",
                  scenarios > 1
                      ? "of compare: rank in the scenario that has this letter above the table; x: a run failed"
                      : "rank",
                  [s](const StandingsRow& r) { return rank_text(*r[s]); });
    if (!with_spread) continue;
    columns.print("mean", "1", "mean", [s](const StandingsRow& r) { return mean_text(*r[s]); });
    columns.print("spread", "1", "spread", [s](const StandingsRow& r) { return significant(r[s]->spread, 2); });
  }
  return columns;
}

std::string standings_text(const League& league, std::size_t metric) {
  const std::size_t scenarios = league.scenarios.size();
  std::vector<StandingsRow> rows(league.algorithms.size());
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t s = 0; s < scenarios; ++s) rows[a].push_back(&league.at(s, a, metric));
  const Table table = standings_columns(scenarios, true).table(rows);
  return table.width() <= prose_width() ? table.text()
                                        : standings_columns(scenarios, false).table(rows).text(prose_width());
}

Columns<LawStanding> mean_rank_columns() {
  Columns<LawStanding> columns;
  columns.print("algorithm", "", "", &LawStanding::algorithm);
  columns.print("mean rank", "1",
                "mean of the algorithm's ranks over all metrics and scenarios, with those after failures",
                [](const LawStanding& l) { return significant(l.mean_rank, 3); });
  columns.print("fails", "", "letters of the scenarios in which a run failed",
                [](const LawStanding& l) { return letters(l.fails); });
  return columns;
}

/// Says where no spread is known, and why.
std::string spread_text(const League& league) {
  if (league.seeds < 2) return "one seed: no spread is known; --seeds K gives one\n";
  std::vector<std::size_t> alike;
  for (std::size_t s = 0; s < league.seeds_matter.size(); ++s) {
    if (!league.seeds_matter[s]) alike.push_back(s);
  }
  if (alike.empty()) return "\"hapbench report\" says what lies between laws, seed by seed\n";
  return fmt::format(
      "nothing is random in {}: all seeds are one run, no spread is known; --jitter METRES shifts the start\n",
      letters(alike));
}

/// Names the seeds that the means are over, in a scenario in which some runs failed.
std::string failed_seeds_text(const League& league, std::size_t scenario) {
  std::vector<std::string> failed;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
    const std::size_t failures = league.failures(scenario, a);
    if (failures > 0 && failures < league.seeds) failed.push_back(fmt::format("{} {}", league.algorithms[a], failures));
  }
  if (failed.empty()) return "";
  return fmt::format("\n   means over {} of {} seeds; failed: {}", league.common[scenario].size(), league.seeds,
                     fmt::join(failed, ", "));
}

/// league.csv, a row for each scenario, algorithm and metric.
Columns<Standing> league_columns() {
  Columns<Standing> columns;
  columns.add("scenario", "", "name of the scenario", &Standing::scenario);
  columns.add("algorithm", "", "force algorithm", &Standing::algorithm);
  columns.add("metric", "", "name of the metric; its unit is part of the name", &Standing::metric);
  columns.add("seeds", "1", "seeds of the algorithm in the scenario", &Standing::seeds);
  columns.add("failed", "1", "seeds that failed", &Standing::failed);
  columns.add("outcome", "", "how the runs ended; of several ways with their numbers", &Standing::outcome);
  columns.add("mean", "by name", "mean of the metric over the common seeds; empty when there is none", &Standing::mean);
  columns.add("spread", "by name",
              "standard deviation over these seeds; empty when there is one, or when seeds change nothing",
              &Standing::spread);
  columns.add(
      "rank", "1",
      "1 + the number of algorithms that did better in this scenario by this metric; those with failures are last",
      &Standing::rank);
  columns.add("common_seeds", "1",
              "seeds that mean and spread are over: those in which no algorithm failed that has any success in the "
              "scenario; if there are none, all seeds of the algorithms that never failed",
              &Standing::common_seeds);
  columns.add("better", "",
              "less or more, whichever is better of the metric; empty when neither is, and nothing is ranked",
              [](const Standing& s) {
                return s.better == Better::none ? Cell() : Cell(s.better == Better::less ? "less" : "more");
              });
  return columns;
}

/// For each metric a table of algorithms and scenarios, with rank, mean and spread as far as they fit into the output,
/// then a line for each algorithm.
std::string league_text(const League& league) {
  std::string text;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s)
    text += fmt::format("{}  {}{}\n", letter(s), league.scenarios[s], failed_seeds_text(league, s));
  for (std::size_t m = 0; m < league.metrics.size(); ++m) {
    const Better better = league.better[m];
    text += fmt::format("\n{}, {}\n\n{}", league.metrics[m],
                        better == Better::less   ? "less is better"
                        : better == Better::more ? "more is better"
                                                 : "neither less nor more is better: not ranked",
                        standings_text(league, m));
  }
  return text + fmt::format(
                    "\nall metrics and scenarios\n\n{}\n"
                    "Means closer than {} % share a rank. x: a run failed; it ranks behind all that did not, by the\n"
                    "number of failures; of the others those without such a number are last.\n{}",
                    mean_rank_columns().table(league.laws).text(), 100.0 * kSameRank, spread_text(league));
}

Json league_json(const League& league) {
  Json rows = Json::array(), laws = Json::array();
  const Columns<Standing> columns = league_columns();
  for (const Standing& standing : league.standings) rows.push_back(columns.json(standing));
  for (const LawStanding& law : league.laws) {
    std::vector<std::string> fails;
    for (const std::size_t scenario : law.fails) fails.push_back(league.scenarios[scenario]);
    laws.push_back({{"algorithm", law.algorithm}, {"mean_rank", or_null(law.mean_rank)}, {"fails", fails}});
  }
  return {{"standings", std::move(rows)}, {"laws", std::move(laws)}};
}

// ---- Errors of --errors: which numbers are how sure, and which order of laws is larger than that

/// The errors of a comparison's numbers, in words and as JSON.
struct ComparedErrors {
  FinerRuns finer;
  std::string text = {};      ///< for each scenario a table and a sentence on each metric
  Json json = Json::array();  ///< an object for each scenario and metric
};

/// The means of a metric in a scenario, by algorithm, and what is known of their errors.
struct MetricNumbers {
  std::vector<NumberWithError> numbers = {};
  std::vector<KnownError> known = {};
};

/// The mean of an algorithm's errors over the common seeds, which bounds the error of their mean.
KnownError mean_error(const League& league, const FinerRuns& finer, std::size_t scenario, std::size_t algorithm,
                      const std::string& metric) {
  const std::vector<std::size_t>& seeds = league.common[scenario];
  KnownError mean{.step = 0.0, .spacing = 0.0};
  const auto add = [&seeds](std::optional<double>& sum, const std::optional<double>& error) {
    sum = sum && error ? std::optional(*sum + *error / static_cast<double>(seeds.size())) : std::nullopt;
  };
  for (const std::size_t seed : seeds) {
    const std::size_t run = (scenario * league.algorithms.size() + algorithm) * league.seeds + seed;
    const KnownError known = finer.known_error(run, metric);
    add(mean.step, known.step);
    add(mean.spacing, known.spacing);
    mean.has_points = known.has_points;
    mean.tolerance += known.tolerance / static_cast<double>(seeds.size());
  }
  return mean;
}

MetricNumbers numbers_of(const League& league, const FinerRuns& finer, std::size_t scenario, std::size_t metric) {
  MetricNumbers found;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
    const KnownError& known = found.known.emplace_back(mean_error(league, finer, scenario, a, league.metrics[metric]));
    const bool failed = league.failures(scenario, a) > 0;
    found.numbers.push_back({failed ? std::nullopt : league.at(scenario, a, metric).mean, known.sum()});
  }
  return found;
}

/// The JSON of a metric's numbers and of the order of laws that their errors leave.
Json numbers_json(const MetricNumbers& found, const std::vector<std::string>& algorithms) {
  Json numbers = Json::array(), order = Json::array();
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    numbers.push_back({{"algorithm", algorithms[a]},
                       {"value", or_null(found.numbers[a].value)},
                       {"error_estimate", or_null(found.numbers[a].error)},
                       {"error_of_step", or_null(found.known[a].step)},
                       {"error_of_spacing", or_null(found.known[a].spacing)}});
  }
  for (const auto& group : held_order(found.numbers, kSameRank).groups) {
    Json& names = order.emplace_back(Json::array());
    for (const std::size_t a : group) names.push_back(algorithms[a]);
  }
  return {{"order", std::move(order)}, {"numbers", std::move(numbers)}};
}

/// Adds a table of the numbers of a scenario with their errors, and a sentence on each metric.
void add_errors(const League& league, std::size_t scenario, ComparedErrors& errors) {
  Columns<std::size_t> columns;  // a row is the place of an algorithm
  columns.print("algorithm", "", "", [&league](std::size_t a) { return league.algorithms[a]; });
  std::string sentences;
  for (std::size_t m = 0; m < league.metrics.size(); ++m) {
    const std::string& metric = league.metrics[m];
    const MetricNumbers found = numbers_of(league, errors.finer, scenario, m);
    const auto* heading = std::ranges::find(kRunHeadings, metric, &RunHeading::metric);
    const bool known = heading != std::end(kRunHeadings);
    const double factor = known ? heading->factor : 1.0;
    columns.print(known ? heading->title : metric, "by name", "", [numbers = found.numbers, factor](std::size_t a) {
      const auto& [value, error] = numbers[a];
      const auto scaled = error ? std::optional(factor * *error) : std::nullopt;
      return value ? with_error_text(factor * *value, scaled) : "-";
    });
    const std::string says = held_text(found.numbers, league.algorithms, kSameRank);
    sentences += wrapped(fmt::format("{}: {}", metric, says), 0);
    Json& json = errors.json.emplace_back(Json{{"scenario", league.scenarios[scenario]}, {"metric", metric}});
    json.update(numbers_json(found, league.algorithms));
    json["says"] = says;
  }
  std::vector<std::size_t> places(league.algorithms.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  errors.text +=
      fmt::format("\nhow sure: {}\n\n{}\n{}\n{}", league.scenarios[scenario], columns.table(places).text(prose_width()),
                  sentences, wrapped(fmt::format("+-: {}", errors.finer.refined(scenario)), 0));
}

/// Runs the comparison more finely. Comparison and reports have to outlive the answer. Throws Stopped.
ComparedErrors errors_of(const League& league, const Comparison& comparison, std::span<const Result> reports,
                         const JobOptions& jobs) {
  ComparedErrors errors{FinerRuns(comparison, reports, jobs)};
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) add_errors(league, s, errors);
  errors.text +=
      "\n" +
      wrapped(
          "+-: how far half and a quarter of the step and of the distance of the points move a number, and what the metric "
          "itself may be wrong by. <: less by more than both errors, every law to the left than every one to the right; ~: "
          "not so. -: a run failed. ?: a finer run ends otherwise or has no such number.",
          0);
  return errors;
}

// ---- The command

struct CompareOptions : CommonOptions {
  std::vector<std::string> metrics;
  unsigned seeds = 1;
  double jitter = 0.0;
  bool errors = false;
  std::vector<std::string> scenarios;
  std::vector<std::string> algorithms;  ///< empty: all
};

Comparison planned(const CompareOptions& options) {
  if (!options.metrics.empty()) require_names("--by: got", options.metrics, metric_names());
  constexpr double kMostJitter = 1.0;
  if (!(options.jitter >= 0.0 && options.jitter <= kMostJitter)) {
    throw InputError(fmt::format("--jitter: got {}; allowed: 0 ... {} m", options.jitter, kMostJitter));
  }
  const std::vector<std::string>& algorithms = options.algorithms;
  return planned(ComparisonQuestion{
      .scenarios = find_scenarios(options.scenarios),
      .algorithms =
          algorithms.empty() ? algorithm_names() : chosen_names("--algorithms: got", algorithms, algorithm_names()),
      .overrides = options.overrides,
      .seeds = options.seeds,
      .jitter = options.jitter});
}

/// A comparison, where its files go, and whether there are several scenarios or seeds to rank over, or metrics to rank
/// by.
struct Asked {
  const CompareOptions& options;
  const Comparison comparison = planned(options);
  const bool league = comparison.scenes.size() > 1 || options.seeds > 1 || !options.metrics.empty();
  const fs::path out =
      results_directory(options.out, comparison.scenes.size() > 1 ? "compare" : "compare_" + comparison.names[0]);

  fs::path table(std::size_t scene) const { return comparison.scene_folder(scene) / "comparison.csv"; }
  std::span<const Result> of(std::size_t scene, const std::vector<Result>& reports) const {
    return std::span(reports).subspan(scene * comparison.each(), comparison.each());
  }
};

/// Makes the directories and removes the results of an earlier comparison from them.
void prepare(const Asked& asked) {
  const Comparison& comparison = asked.comparison;
  ResultList results;
  double bytes = 0.0;
  for (std::size_t i = 0; i < comparison.size(); ++i) results.runs.push_back(comparison.folder(i));
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    results.tables.push_back(asked.table(s));
    bytes += static_cast<double>(comparison.each()) * expected_output_bytes(comparison.scenes[s].load(0).scenario);
  }
  if (asked.league) results.tables.emplace_back("league.csv");
  for (const fs::path& run : results.runs) require_writable_directory(asked.out / run);
  replace_earlier_results(asked.out, results);
  announce_large_output(bytes);
}

/// The metrics of the league, or without one those of the printed table.
std::vector<std::string> compared(const Asked& asked, const std::vector<Result>& reports) {
  if (asked.league) return asked.options.metrics;
  std::vector<std::string> metrics;
  for (const RunHeading& heading : kRunHeadings) metrics.emplace_back(heading.metric);
  if (have_reference(reports)) metrics.insert(metrics.end(), kFidelityMetrics, std::end(kFidelityMetrics) - 1);
  return metrics;
}

/// What the runs gave, and more finely, where that was asked for.
struct Answer {
  std::vector<Result> reports;
  League league = {};
  std::optional<ComparedErrors> errors = {};
};

Answer answer_to(const Asked& asked) {
  const CompareOptions& options = asked.options;
  const JobOptions jobs = job_options(options, "compare");
  // The table of a single comparison shows times, which concurrent runs would lengthen.
  const unsigned at_once = options.jobs > 0 || asked.league ? jobs.threads : 1;
  try {
    Answer answer{run_all(asked.comparison.scenes, {at_once, jobs.label},
                          [&asked](std::size_t run) { return asked.out / asked.comparison.folder(run); })};
    answer.league = league_of(asked.comparison, answer.reports, compared(asked, answer.reports));
    if (options.errors) answer.errors.emplace(errors_of(answer.league, asked.comparison, answer.reports, jobs));
    return answer;
  } catch (const Stopped&) {
    forget_results_if_none(asked.out);
    throw;
  }
}

/// Widens the tolerances of the runs' metrics to what is known of their errors.
void widen_tolerances(std::vector<Result>& reports, const ComparedErrors& errors) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    for (Metric& metric : reports[i].metrics)
      if (const auto error = errors.finer.known_error(i, metric.name).sum()) metric.within(0.0, *error);
  }
}

/// The tables of one scenario's runs.
std::string comparison_text(std::span<const Result> reports) {
  return fmt::format("{}\n\n{}{}{}{}", reports.front().name, run_table(reports, false), fidelity_text(reports),
                     unsettled_text(reports), step_time_text(reports));
}

/// Names the algorithms of a single scenario whose definition fixes a depth model, if others use another one. Each of
/// their runs would warn of it.
std::string own_depth_models_text(const Comparison& comparison) {
  std::vector<std::string> own;
  std::set<std::string> models;
  for (std::size_t i = 0; i < comparison.size(); i += comparison.seeds) {
    const Scenario scenario = comparison.load(i).scenario;
    if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return "";
    const RenderingConfig& rendering = scenario.rendering;
    models.insert(rendering.depth_model);
    if (!find_algorithm(rendering.algorithm)->fixed_depth_model.empty())
      own.push_back(fmt::format("{} with {}", rendering.algorithm, rendering.depth_model));
  }
  if (models.size() < 2) return "";
  return wrapped(fmt::format("defined with a depth model of their own: {}", fmt::join(own, ", ")), 0);
}

Json summaries_json(const Asked& asked, const std::vector<Result>& reports) {
  const Comparison& comparison = asked.comparison;
  Json summaries = Json::array();
  for (std::size_t i = 0; i < reports.size(); ++i) {
    Json& summary = summaries.emplace_back(Json::object());
    if (asked.league) summary = {{"scenario", comparison.names[comparison.scene(i)]}, {"seed", i % comparison.seeds}};
    summary.update(summary_json(reports[i]));
  }
  return summaries;
}

/// Reports runs that diverge although their scenario does not expect it, the only expectation that concerns every
/// algorithm: all of a single comparison, the first of a league.
void judge(const Asked& asked, const std::vector<Result>& reports, Report& report) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const Result& summary = reports[i];
    if (summary.end.outcome != Outcome::diverges) continue;
    const LoadedScenario loaded = asked.comparison.load(i);
    if (outcome_is_expected(loaded.scenario.expect, Outcome::diverges)) continue;
    const Divergence& d = summary.end.divergence;
    texts.push_back(fmt::format("{}: {} diverges at step {}{}", loaded.file.string(), summary.algorithm, d.step,
                                d.fault.empty() ? "" : ": " + d.fault));
  }
  if (asked.league && !texts.empty())
    texts = {fmt::format("{} of {} runs diverge, the first: {}", texts.size(), reports.size(), texts.front())};
  for (const std::string& text : texts) report.fault(text, kUnexpectedOutcome);
}

int compare(const CompareOptions& options) {
  if (options.scenarios.empty())
    throw InputError("compare: scenarios is required; \"hapbench compare --help\" explains");
  // All input is checked before anything runs or is written.
  const Asked asked{options};
  print_warnings(asked.comparison.warnings);
  prepare(asked);
  auto [reports, league, errors] = answer_to(asked);
  Report report(options.output, asked.out);
  for (std::size_t s = 0; s < asked.comparison.scenes.size(); ++s) {
    print_warnings(run_warnings(asked.of(s, reports)));
    report.write(asked.table(s).c_str(), comparison_columns(options.seeds > 1),
                 compared_runs(asked.of(s, reports), options.seeds));
  }
  report.json() = summaries_json(asked, reports);
  if (asked.league) {
    report.write("league.csv", league_columns(), league.standings);
    report.say(league_text(league));
    report.json() = {{"runs", std::move(report.json())}};
    report.json().update(league_json(league));
  } else {
    if (errors) widen_tolerances(reports, *errors);
    report.say(comparison_text(reports) + own_depth_models_text(asked.comparison));
    if (errors) report.json() = {{"runs", std::move(report.json())}};
  }
  if (errors) {
    report.say(errors->text);
    report.json()["errors"] = std::move(errors->json);
  }
  report.say(fmt::format("\nresults in {}\n", asked.out.string()));
  judge(asked, reports, report);
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> league_tables() {
  return {league_columns().described(
              "league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric"),
          standings_columns(26, false).described(), standings_columns(1, true).described(),
          mean_rank_columns().described()};
}

void add_compare(CommandLine& line) {
  auto [command, options] =
      line.command("compare", "Run scenarios through several algorithms side by side; several scenarios give a league",
                   compare, "the folders of finished runs are kept, but no table is written");
  command.add("scenarios", options.scenarios, "scenario files, names of bundled scenarios, or of groups of them");
  command.add("--algorithms", options.algorithms, "names, separated by commas, or all (default: all)",
              {.comma_separated = true});
  command.add("--seeds", options.seeds, "run each K times, time k with the scenario's seed + k (default: 1)",
              {.range = {{1, 10'000}}});
  command.add(
      "--jitter", options.jitter,
      "shift the start by a vector of this length [m] whose direction depends on the seed and is the same for all "
      "algorithms: gives a spread where nothing else is random");
  command.add("--by", options.metrics,
              "metrics of the league, less is better: names of summary.json, separated by commas (default: " +
                  fmt::format("{}", fmt::join(kDefaultMetrics, ",")) +
                  "; fidelity where every scene has a reference force)",
              {.comma_separated = true});
  add_jobs(command, options.jobs, "runs at once (default: one per thread; 1 where the table shows times)");
  command.add(
      "--out", options.out,
      "directory of the results (default: results/out/compare_NAME, for several scenarios results/out/compare)");
  add_overrides(command, options.overrides);
  command.flag("--errors", options.errors,
               "also run each at half and a quarter of the step and of the distance of the shell's points, and say of "
               "each metric how far that moves it and which laws' order holds");
  command.footer(
      "Files go to OUT/[SCENARIO/]ALGORITHM[/seed_K], the parts in brackets where there are several, and "
      "comparison.csv of each scenario beside them. Several scenarios or seeds, or --by, give a league: rank, mean and "
      "spread over the seeds, and where each algorithm fails; league.csv has all of it. A run fails when it diverges, has no contact or loses it, goes through the "
      "surface, is not dragged or stuck, or "
      "ends otherwise than its scenario allows; it ranks behind all others. The results of an earlier comparison in OUT "
      "are removed, other files are not.");
}

}  // namespace hapbench
