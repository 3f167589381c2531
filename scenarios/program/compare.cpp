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
#include "scenarios/cases/comparison.hpp"
#include "scenarios/cases/league.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/limits/convergence/convergence.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/league_table.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

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

/// Without finer runs the errors are the metric's own tolerances. Laws that failed have no number.
MetricNumbers numbers_of(const League& league, const FinerRuns* finer, std::size_t scenario, std::size_t metric) {
  MetricNumbers found;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
    const Standing& standing = league.at(scenario, a, metric);
    KnownError known{.step = 0.0, .spacing = 0.0, .tolerance = standing.tolerance.value_or(0.0)};
    if (finer != nullptr) known = mean_error(league, *finer, scenario, a, standing.metric);
    found.numbers.push_back({standing.failed > 0 ? std::nullopt : standing.mean, known.sum()});
    found.known.push_back(known);
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

/// Adds a table of the numbers of a scenario with their errors, and a sentence on each metric that it shows.
void add_errors(const League& league, std::size_t scenario, bool all, ComparedErrors& errors) {
  Columns<std::size_t> columns;  // a row is the place of an algorithm
  columns.print("algorithm", "", "", [&league](std::size_t a) { return league.algorithms[a]; });
  const std::vector<RunHeading> headings = shown_headings();
  std::string sentences;
  for (std::size_t m = 0; m < league.metrics.size(); ++m) {
    const std::string& metric = league.metrics[m];
    const MetricNumbers found = numbers_of(league, &errors.finer, scenario, m);
    const std::string says = held_text(found.numbers, league.algorithms, kSameRank);
    Json& json = errors.json.emplace_back(Json{{"scenario", league.scenarios[scenario]}, {"metric", metric}});
    json.update(numbers_json(found, league.algorithms));
    json["says"] = says;
    const auto heading = std::ranges::find(headings, metric, &RunHeading::metric);
    const bool known = heading != headings.end();
    if (!known && !all) continue;
    const double factor = known ? heading->factor : 1.0;
    columns.print(known ? heading->title : metric, "by name", "", [numbers = found.numbers, factor](std::size_t a) {
      const auto& [value, error] = numbers[a];
      return value ? with_error_text(factor * *value, error ? std::optional(factor * *error) : error) : "-";
    });
    sentences += wrapped(fmt::format("{}: {}", metric, says), 0);
  }
  std::vector<std::size_t> places(league.algorithms.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  errors.text +=
      fmt::format("\nhow sure: {}\n\n{}\n{}\n{}", league.scenarios[scenario], columns.table(places).text(prose_width()),
                  sentences, wrapped(fmt::format("+-: {}", errors.finer.refined(scenario)), 0));
}

// ---- Who does better, in a sentence

/// "14 times less" or "3 % less", for a number below another one.
std::string less_text(double less, double more) {
  if (less * 1000.0 < more) return "over 1000 times less";
  return less * 2.0 <= more ? fmt::format("{:.2g} times less", more / less)
                            : fmt::format("{:.2g} % less", 100.0 * (1.0 - less / more));
}

/// "enters 3 % deeper"; empty where a depth is not known.
std::string depth_text(const NumberWithError& here, const NumberWithError& there) {
  if (!here.value || !there.value) return "";
  const auto [less, more] = std::minmax(*here.value, *there.value);
  const double error = here.error.value_or(more) + there.error.value_or(more);
  if (more - less <= std::max(error, kSameRank * more)) return ", and enters as deep, within the error";
  if (*here.value == less) return fmt::format(", and enters {} deep", less_text(less, more));
  return more >= 2.0 * less ? fmt::format(", and enters {:.2g} times as deep", more / less)
                            : fmt::format(", and enters {:.2g} % deeper", 100.0 * (more / less - 1.0));
}

/// Says which law of a scene vibrates least and how deep its tool enters, or that this is not decided. Where a law has
/// no settled contact, as one that throws the tool out, the vibration is that of the tool.
std::string scene_verdict(const League& league, const FinerRuns* finer) {
  constexpr double kUnfelt = 1e-4, kUnfeltPower = 1e-10;  // [N], [m2/s2] of vibration, below what any hand feels
  const auto numbers = [&](const char* metric, double least_error) {
    const auto place = std::ranges::find(league.metrics, metric) - league.metrics.begin();
    std::vector<NumberWithError> found = numbers_of(league, finer, 0, static_cast<std::size_t>(place)).numbers;
    for (NumberWithError& number : found)
      if (number.error) *number.error += least_error;
    return found;
  };
  std::vector<std::string> failing, others;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a)
    (league.failures(0, a) > 0 ? failing : others).push_back(league.algorithms[a]);
  const std::size_t left = others.size();
  const std::string fail = failing.empty() ? "" : fmt::format("; failing: {}", fmt::join(failing, ", "));
  if (league.algorithms.size() < 2) return "";
  if (left == 0) return "not decided: every law fails";
  if (left == 1) return fmt::format("{} alone does not fail{}", others[0], fail);
  std::vector<NumberWithError> vibrations = numbers("force_rms_above_30Hz_N", kUnfelt);
  const auto has_value = [](const NumberWithError& number) { return number.value.has_value(); };
  const bool of_force = static_cast<std::size_t>(std::ranges::count_if(vibrations, has_value)) == left;
  if (!of_force) vibrations = numbers(kToolVibrationPower, kUnfeltPower);
  const auto& [groups, unplaced] = held_order(vibrations, kSameRank);
  if (groups.size() < 2 || groups[0].size() > 1 || !unplaced.empty()) {
    return fmt::format("not decided, by the vibration of the {}: {}{}", of_force ? "force" : "tool",
                       held_text(vibrations, league.algorithms, kSameRank), fail);
  }
  const std::size_t best = groups[0][0], next = groups[1][0];
  const auto size = [&](std::size_t a) { return of_force ? *vibrations[a].value : std::sqrt(*vibrations[a].value); };
  const std::vector<NumberWithError> depths = numbers("inside_max_m", 0.0);
  return fmt::format("{} vibrates {} than {}{}{}{}{}{}", league.algorithms[best], less_text(size(best), size(next)),
                     league.algorithms[next], left > 2 ? ", the next" : "",
                     of_force ? "" : " (the tool above 30 Hz, as not all forces settle)",
                     depth_text(depths[best], depths[next]), fail,
                     finer != nullptr ? "" : "; --errors tells whether finer runs agree");
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

/// The metrics of the league, or without one those of the table with --wide.
std::vector<std::string> compared(const Asked& asked, const std::vector<Result>& reports) {
  if (asked.league) return asked.options.metrics;
  std::vector<std::string> metrics = {"force_max_N", kToolVibrationPower};
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
  // The wide table of a single comparison shows times, which concurrent runs would lengthen.
  const unsigned at_once = options.jobs > 0 || asked.league || !output_is_in_full() ? jobs.threads : 1;
  try {
    Answer answer{run_all(asked.comparison.scenes, {at_once, jobs.label},
                          [&asked](std::size_t run) { return asked.out / asked.comparison.folder(run); })};
    const League& league = answer.league = league_of(asked.comparison, answer.reports, compared(asked, answer.reports));
    if (!options.errors) return answer;
    ComparedErrors& errors = answer.errors.emplace(ComparedErrors{FinerRuns(asked.comparison, answer.reports, jobs)});
    for (std::size_t s = 0; s < league.scenarios.size(); ++s)
      add_errors(league, s, asked.league || output_is_in_full(), errors);
    errors.text += "\n" + wrapped("<: less by more than both errors; ~: not so; ?: a finer run ends otherwise", 0);
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

/// The tables of one scenario's runs, and who does better.
std::string comparison_text(const Answer& answer) {
  const std::vector<Result>& reports = answer.reports;
  const std::string verdict = scene_verdict(answer.league, answer.errors ? &answer.errors->finer : nullptr);
  return fmt::format("{}\n\n{}{}{}{}{}", reports.front().name, run_table(reports, false), fidelity_text(reports),
                     unsettled_text(reports), verdict.empty() ? "" : "\n" + wrapped(verdict, 0),
                     output_is_in_full() ? step_time_text(reports) : "");
}

/// Names the algorithms of a single scenario whose definition fixes a depth model, if others use another one. Each of
/// their runs would warn of it.
std::string own_depth_models_text(const Comparison& comparison) {
  if (std::holds_alternative<SpringsEnvironment>(comparison.load(0).scenario.environment)) return "";
  std::vector<std::string> own;
  std::set<std::string> models;
  for (std::size_t i = 0; i < comparison.size(); i += comparison.seeds) {
    const auto [model, fixed] = std::pair(comparison.load(i).scenario.rendering.depth_model,
                                          find_algorithm(comparison.algorithm(i))->fixed_depth_model);
    models.insert(model);
    if (!fixed.empty()) own.push_back(fmt::format("{} with {}", comparison.algorithm(i), model));
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
  Answer answer = answer_to(asked);
  std::vector<Result>& reports = answer.reports;
  Report report(options.output, asked.out);
  for (std::size_t s = 0; s < asked.comparison.scenes.size(); ++s) {
    print_warnings(run_warnings(asked.of(s, reports)));
    std::vector<ComparedRun> runs;
    for (const Result& run : asked.of(s, reports)) runs.push_back({runs.size() % options.seeds, &run});
    report.write(asked.table(s).c_str(), comparison_columns(options.seeds > 1), runs);
  }
  report.json() = summaries_json(asked, reports);
  if (asked.league) {
    report.write("league.csv", league_columns(false), answer.league.standings);
    report.say(league_text(answer.league));
    report.json() = {{"runs", std::move(report.json())}};
    report.json().update(league_json(answer.league));
  } else {
    if (answer.errors) widen_tolerances(reports, *answer.errors);
    report.say(comparison_text(answer) + own_depth_models_text(asked.comparison));
    if (answer.errors) report.json() = {{"runs", std::move(report.json())}};
  }
  if (answer.errors) {
    report.say(answer.errors->text);
    report.json()["errors"] = std::move(answer.errors->json);
  }
  report.say(fmt::format("\nresults in {}\n", asked.out.string()));
  judge(asked, reports, report);
  return report.finish();
}

}  // namespace

void add_compare(CommandLine& line) {
  auto [command, options] =
      line.command("compare", "Run scenarios through several algorithms side by side; several scenarios give a league",
                   compare, "the folders of finished runs are kept, but no table is written");
  command.add("scenarios", options.scenarios, "scenario files, names of bundled scenarios, or of groups of them");
  add_algorithms(command, options.algorithms, "all");
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
