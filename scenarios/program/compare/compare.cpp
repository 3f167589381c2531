#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/analysis/convergence/convergence.hpp"
#include "scenarios/input/bundled_files.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

/// Programs may read these by their place: append new ones.
constexpr std::string_view kComparedMetrics =
    "force_max_N velocity_total_variation_m_per_s force_reversals vibration_power_above_30Hz_m2_per_s2 depth_max_m "
    "ratio_min ratio_max steps_in_contact contact_share landings landing_force_max_N landing_force_step_max_N settled_s "
    "force_mean_in_contact_N settled_force_max_N force_step_p99_N settled_force_step_max_N force_rms_above_30Hz_N "
    "force_reversals_per_s reduction_changes reduction_force_step_max_N inside_max_m inside_settled_m "
    "centre_inside_share vibration_last_quarter_m_per_s fidelity.force_error_relative "
    "fidelity.force_direction_error_rad fidelity.force_artefact_share";

/// A line: a run, and the number of its repetition.
struct ComparedRun {
  std::uint64_t seed;
  const Result& run;
};

/// Without times, so that equal comparisons give equal bytes; several seeds get a column in front.
Columns<ComparedRun> comparison_columns(bool seeds) {
  using Row = ComparedRun;
  Columns<Row> columns = {
      {"seed", "1", "number of the repetition", &Row::seed, when(seeds)},
      {"algorithm", "", "force algorithm", [](const Row& r) { return r.run.algorithm; }},
      {"outcome", "", "how the run ended", [](const Row& r) { return outcome_name(r.run.end.outcome); }},
      {"steps", "1", "rows of the run", [](const Row& r) { return r.run.end.rows; }}};
  for (const std::string_view name : words_of(kComparedMetrics)) {
    const Metric& metric = *find_metric(all_metrics(), name);
    columns.add(
        {{metric.name, metric.unit, metric.meaning, [name](const Row& r) { return value_of(r.run.metrics, name); }}});
  }
  return columns;
}

// ---- The league

/// By how much the mean may be wrong: as its numbers, or by other seeds; at least what means of one rank differ by.
std::optional<double> error_of_mean(const Standing& standing) {
  if (!standing.spread) return standing.tolerance;
  const double of_seeds = *standing.spread / std::sqrt(static_cast<double>(standing.common_seeds));
  return std::max(
      {standing.tolerance, std::optional(of_seeds), std::optional(0.1 * kSameRank * std::abs(*standing.mean))});
}

/// True for the row that comes first in a table: by rank, of one rank by mean; those without a rank come last.
bool comes_first(const Standing& a, const Standing& b) {
  if (a.rank != b.rank) return a.rank && (!b.rank || *a.rank < *b.rank);
  if (a.better == Better::none) return false;
  if (!a.mean || !b.mean) return a.mean && !b.mean;
  return a.better == Better::more ? *a.mean > *b.mean : *a.mean < *b.mean;
}

/// The standings by scenario and metric, best first.
std::vector<Standing> ranked(const League& league) {
  std::vector<Standing> all;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s) {
    for (std::size_t m = 0; m < league.metrics.size(); ++m) {
      const auto first = static_cast<std::ptrdiff_t>(all.size());
      for (std::size_t a = 0; a < league.algorithms.size(); ++a) all.push_back(league.at(s, a, m));
      std::stable_sort(all.begin() + first, all.end(), comes_first);
    }
  }
  return all;
}

Columns<LawStanding> law_columns() {
  const auto fails = [](const LawStanding& l) {
    return l.fails.empty() ? "-" : fmt::format("{}", fmt::join(l.fails, ", "));
  };
  return {{"algorithm", "", "", &LawStanding::algorithm, under("algorithm")},
          {"mean_rank", "1", "mean of the algorithm's ranks over all metrics and scenarios, with those after failures",
           &LawStanding::mean_rank, under("mean rank", 3)},
          {"fails in", "", "scenarios in which a run failed", fails, only_printed()}};
}

std::string firsts_text(const League& league) {
  constexpr std::size_t kMostNamed = 5;
  if (!league.laws.front().mean_rank) return "nothing is ranked: neither less nor more of these metrics is better";
  std::size_t rankings = 0;  // as many of each law
  std::vector<std::string> firsts;
  for (const LawStanding& law : league.laws) {
    std::size_t first = rankings = 0;
    for (const Standing& standing : league.standings) {
      if (standing.algorithm != law.algorithm || !standing.rank) continue;
      ++rankings;
      first += *standing.rank == 1;
    }
    if (first > 0) firsts.push_back(fmt::format("{} in {}", law.algorithm, first));
  }
  if (firsts.size() == 1)
    return fmt::format("{} alone is first in each of {} rankings", league.laws.front().algorithm, rankings);
  return fmt::format("no algorithm alone is first in each of {} rankings; first are {}", rankings,
                     fmt::join(first_few(firsts, kMostNamed), ", "));
}

std::string verdict(const League& league) {
  const std::string text = wrapped(firsts_text(league), 0);
  if (league.seeds < 2) return text + "one seed: no spread is known; --seeds K gives one\n";
  std::vector<std::string> alike;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s)
    if (!league.seeds_matter[s]) alike.push_back(league.scenarios[s]);
  if (alike.empty()) return text + "\"hapbench report\" says what lies between laws, seed by seed\n";
  return text + wrapped(fmt::format("nothing is random in {}: all seeds are one run, no spread is known; --jitter "
                                    "METRES shifts the start",
                                    fmt::join(alike, ", ")),
                        0);
}

/// league.csv, a row for each scenario, algorithm and metric; `seeds`: there are several.
Columns<Standing> league_columns(bool seeds) {
  using Row = Standing;
  const auto better = [](const Row& r) {
    return r.better == Better::none ? Cell() : Cell(r.better == Better::less ? "less" : "more");
  };
  return {
      {"scenario", "", "name of the scenario", &Row::scenario, under("scenario")},
      {"algorithm", "", "force algorithm", &Row::algorithm, under("algorithm")},
      {"metric", "", "name of the metric; its unit is part of the name", &Row::metric, under("metric")},
      {"seeds", "1", "seeds of the algorithm in the scenario", &Row::seeds},
      {"failed", "1", "seeds that failed", &Row::failed},
      {"outcome", "", "how the runs ended; of several ways with their numbers", &Row::outcome, under("how it ended")},
      {"mean", "by name", "mean of the metric over the common seeds; empty when there is none", &Row::mean,
       under("mean"), error_of_mean},
      {"spread", "by name",
       "standard deviation over these seeds; empty when there is one, or when seeds change nothing", &Row::spread,
       under(seeds ? "spread" : "", 2)},
      {"rank", "1",
       "1 + the number of algorithms that did better in this scenario by this metric, by more than 0.1 % and both "
       "errors; those with failures are last, by the number of these",
       &Row::rank, under("rank")},
      {"common_seeds", "1",
       "seeds that mean and spread are over: those in which no algorithm failed that has any success in the "
       "scenario; if there are none, all seeds of the algorithms that never failed",
       &Row::common_seeds},
      {"better", "", "less or more, whichever is better of the metric; empty when neither is, and nothing is ranked",
       better}};
}

std::string league_text(const League& league) {
  constexpr std::size_t kMostPrinted = 60;
  const std::string table =
      league.standings.size() <= kMostPrinted || output_in_full()
          ? league_columns(league.seeds > 1).table(ranked(league)).text()
          : fmt::format("{} standings are in league.csv; --wide prints them\n", league.standings.size());
  return fmt::format("{}\n{}\n{}", table, law_columns().table(league.laws).text(), verdict(league));
}

// ---- How sure the numbers are, and which order of laws is larger than that

/// The mean of an algorithm's errors over the common seeds, which bounds the error of their mean.
KnownError mean_error(const League& league, const FinerRuns& finer, std::size_t scenario, std::size_t algorithm,
                      const std::string& metric) {
  const std::vector<std::size_t>& seeds = league.common[scenario];
  KnownError mean{.step = 0.0, .spacing = 0.0};
  const auto add = [&seeds](std::optional<double>& sum, const std::optional<double>& error) {
    sum = sum && error ? std::optional(*sum + *error / static_cast<double>(seeds.size())) : std::nullopt;
  };
  for (const std::size_t seed : seeds) {
    const KnownError known = finer.known_error(league.first_run(scenario, algorithm) + seed, metric);
    add(mean.step, known.step);
    add(mean.spacing, known.spacing);
    mean.has_points = known.has_points;
    mean.tolerance += known.tolerance / static_cast<double>(seeds.size());
  }
  return mean;
}

/// The means of a metric in a scenario by algorithm, none of laws that failed; adds them and their order to the JSON.
std::vector<NumberWithError> numbers_of(const League& league, const FinerRuns& finer, std::size_t scenario,
                                        std::size_t metric, Json& json) {
  std::vector<NumberWithError> numbers;
  Json rows = Json::array(), order = Json::array();
  for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
    const Standing& standing = league.at(scenario, a, metric);
    const KnownError known = mean_error(league, finer, scenario, a, standing.metric);
    const auto& [value, error] =
        numbers.emplace_back(NumberWithError{standing.failed > 0 ? std::nullopt : standing.mean, known.sum()});
    rows.push_back({{"algorithm", standing.algorithm},
                    {"value", cell_json(cell_of(value))},
                    {"error_estimate", cell_json(cell_of(error))},
                    {"error_of_step", cell_json(cell_of(known.step))},
                    {"error_of_spacing", cell_json(cell_of(known.spacing))}});
  }
  for (const auto& group : held_order(numbers).groups) {
    Json& names = order.emplace_back(Json::array());
    for (const std::size_t a : group) names.push_back(league.algorithms[a]);
  }
  json["order"] = std::move(order);
  json["numbers"] = std::move(rows);
  return numbers;
}

/// Reports a table of the numbers of a scenario with their errors, and a sentence on each metric that it shows.
void report_errors(const League& league, const FinerRuns& finer, std::size_t scenario, bool all, Report& report) {
  Table table{{{"algorithm", false}}};
  for (const std::string& algorithm : league.algorithms) table.rows.push_back({algorithm});
  std::string sentences;
  for (std::size_t m = 0; m < league.metrics.size(); ++m) {
    const std::string& metric = league.metrics[m];
    Json& json =
        report.json()["errors"].emplace_back(Json{{"scenario", league.scenarios[scenario]}, {"metric", metric}});
    const std::vector<NumberWithError> numbers = numbers_of(league, finer, scenario, m, json);
    const std::string says = held_text(numbers, league.algorithms);
    json["says"] = says;
    const auto* heading = std::ranges::find(kRunHeadings, metric, &RunHeading::metric);
    const bool known = heading != std::end(kRunHeadings);
    if (!all && (!known || heading->wide)) continue;
    const double factor = known ? heading->factor : 1.0;
    table.columns.push_back({known ? heading->title : metric});
    for (std::size_t a = 0; a < numbers.size(); ++a) {
      const auto& [value, error] = numbers[a];
      const auto shown_error = error ? std::optional(factor * *error) : error;
      table.rows[a].push_back(value ? with_error_text(factor * *value, shown_error) : "-");
    }
    sentences += wrapped(fmt::format("{}: {}", metric, says), 0);
  }
  report.say(fmt::format("\nhow sure: {}\n\n{}\n{}\n{}", league.scenarios[scenario], table.text(prose_width()),
                         sentences, wrapped(fmt::format("+-: {}", finer.refined(scenario)), 0)));
}

/// Which laws vibrate less by more than hands feel; where one has no settled contact, by the vibration of the tool.
std::string vibration_text(const League& league) {
  struct Vibration {
    const char *of, *metric;
    double unfelt;  ///< [unit of the metric]
  };
  constexpr Vibration kVibrations[] = {{"force", "force_rms_above_30Hz_N", 1e-4}, {"tool", kToolVibrationPower, 1e-10}};
  if (league.algorithms.size() < 2) return "";
  std::string says;
  std::vector<std::string> failing;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a)
    if (league.failures(0, a) > 0) failing.push_back(league.algorithms[a]);
  for (const auto& [of, metric, unfelt] : kVibrations) {
    const auto place = static_cast<std::size_t>(std::ranges::find(league.metrics, metric) - league.metrics.begin());
    std::vector<NumberWithError> numbers;
    std::size_t known = 0;
    for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
      const Standing& standing = league.at(0, a, place);
      numbers.push_back(
          {standing.failed > 0 ? std::nullopt : standing.mean, standing.tolerance.value_or(0.0) + unfelt});
      known += numbers.back().value.has_value();
    }
    says = fmt::format("vibration of the {}: {}", of, held_text(numbers, league.algorithms));
    if (known + failing.size() == league.algorithms.size()) break;
  }
  if (!failing.empty()) says += fmt::format("; failing: {}", fmt::join(failing, ", "));
  return "\n" + wrapped(says + "; --errors tells whether finer runs agree", 0);
}

// ---- The command

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

int compare(const CompareOptions& options) {
  if (options.scenarios.empty())
    throw InputError("compare: scenarios is required; \"hapbench compare --help\" explains");
  // All input is checked before anything runs or is written.
  const Comparison comparison = planned(options);
  const bool several = comparison.scenes.size() > 1;
  // Whether there is something to rank over, or metrics to rank by.
  const bool ranks = several || comparison.seeds > 1 || !options.metrics.empty();
  print_warnings(comparison.warnings);
  Report report(options, several ? "compare" : "compare_" + comparison.names[0]);
  const std::filesystem::path& out = report.folder();
  remove_earlier_comparison(out, comparison);
  for (std::size_t run = 0; run < comparison.size(); ++run) require_writable_directory(out / comparison.folder(run));
  const JobOptions jobs = job_options(options, "compare");
  JobOptions timed = jobs;
  // The wide table of a single comparison shows times, which concurrent runs would lengthen.
  if (options.jobs == 0 && !ranks && output_in_full()) timed.threads = 1;
  const std::vector<Result> reports =
      run_all(comparison.scenes, timed, [&](std::size_t run) { return out / comparison.folder(run); });
  const League league = league_of(comparison, reports, ranks ? options.metrics : printed_metrics(reports));
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const auto of_scene = std::span(reports).subspan(s * comparison.each(), comparison.each());
    print_warnings(run_warnings(of_scene));
    std::vector<ComparedRun> runs;
    for (const Result& run : of_scene) runs.push_back({runs.size() % comparison.seeds, run});
    report.write(comparison.scene_folder(s) / "comparison.csv", comparison_columns(comparison.seeds > 1), runs);
  }
  report.json() = summaries_json(comparison, reports, ranks);
  if (ranks || options.errors) report.json() = {{"runs", std::move(report.json())}};
  if (ranks) {
    report.write("league.csv", league_columns(false), league.standings);
    report.say(league_text(league));
    report.json()["standings"] = league_columns(false).json_list(league.standings);
    Json& laws = report.json()["laws"] = law_columns().json_list(league.laws);
    for (std::size_t i = 0; i < laws.size(); ++i) laws[i]["fails"] = league.laws[i].fails;
  } else {
    report.say(fmt::format("{}\n\n{}{}{}{}", reports.front().name, run_table(reports, false), fidelity_text(reports),
                           options.errors ? "" : vibration_text(league),
                           output_in_full() ? step_time_text(reports) : ""));
  }
  if (options.errors) {
    const FinerRuns finer(comparison, reports, jobs);
    for (std::size_t s = 0; s < league.scenarios.size(); ++s)
      report_errors(league, finer, s, ranks || output_in_full(), report);
    report.say("\n" + wrapped("<: less by more than both errors; ~: not so; ?: a finer run ends otherwise", 0));
  }
  report.say(fmt::format("\nresults in {}\n", out.string()));
  judge(comparison, reports, report);
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> league_tables() {
  return {comparison_columns(false).described("comparison.csv", "of compare: one line per algorithm"),
          league_columns(true).described(
              "league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric"),
          law_columns().described()};
}

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
      "comparison.csv of each scenario beside them. Several scenarios or seeds, or --by, give a league: rank, mean and "
      "spread over the seeds, and where each algorithm fails; league.csv has all of it. A run fails when it diverges, has no contact or loses it, goes through the "
      "surface, is not dragged or stuck, or "
      "ends otherwise than its scenario allows; it ranks behind all others. The results of an earlier comparison in OUT "
      "are removed, other files are not.");
}

}  // namespace hapbench
