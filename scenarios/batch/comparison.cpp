#include "scenarios/batch/comparison.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "algorithms/registry.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/result_folder.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostSeed = std::int64_t{1} << 53;
/// Random stream of the start's shift, which keeps it independent of everything else that the scenario's seed
/// determines.
constexpr std::uint64_t kJitterStream = 0x6a697474;

bool lies_in_the_plane(const Environment& environment) {
  if (std::holds_alternative<Hole2d>(environment)) return true;
  const auto* springs = std::get_if<SpringsEnvironment>(&environment);
  if (springs == nullptr || (springs->random.count > 0 && !springs->random.planar)) return false;
  return std::ranges::all_of(springs->groups, [](const SpringGroup& group) { return group.direction.z() == 0.0; });
}

Vec3 start_shift(const Scenario& scenario, double length) {
  Random random(Random::derive(kJitterStream, static_cast<std::uint64_t>(scenario.seed)));
  return length * (lies_in_the_plane(scenario.environment) ? random.direction_in_plane() : random.direction());
}

void check_seeds_and_jitter(const ComparisonQuestion& question, const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  const std::int64_t most = kMostSeed - static_cast<std::int64_t>(question.seeds - 1);
  if (scenario.seed > most) {
    throw InputError(fmt::format("{}: /seed: got {}; allowed: at most {} with {} seeds", loaded.file.string(),
                                 scenario.seed, most, question.seeds));
  }
  if (question.jitter != 0.0 && !position_is_free(scenario.motion)) {
    throw InputError(fmt::format(
        "{}: /motion/position: prescribes the tool's place, which --jitter cannot shift; allowed with it: \"free\"",
        loaded.file.string()));
  }
}

/// The cases of a scene; adds its warnings, of those about its fields what all algorithms have: what only one of them
/// reads has an effect here.
Cases cases_of(const ComparisonQuestion& question, const fs::path& file, std::vector<std::string>& warnings) {
  const ScenarioText text = read_scenario_text(file);
  std::vector<Axis> axes = {{"rendering.algorithm", question.algorithms}};
  const Cases alone({text}, question.overrides, axes);
  const LoadedScenario first = checked(alone.load(0));  // the files are those of the scenario, whatever the algorithm
  check_seeds_and_jitter(question, first);
  if (question.seeds > 1 || question.jitter != 0.0)
    axes.push_back(seed_axis(first.scenario, question.seeds, question.jitter));
  std::vector<Warning> common = first.warnings;
  for (std::size_t a = 1; a < alone.size(); ++a) {
    const std::vector<Warning> of_this = alone.load(a).warnings;
    std::erase_if(common, [&](const Warning& w) { return std::ranges::find(of_this, w) == of_this.end(); });
  }
  append_new(warnings, with_files(first, first.file_warnings));
  append_new(warnings, with_files(first, common));
  return {{text}, question.overrides, std::move(axes)};
}

// ---- The league

/// The seeds in which none of the algorithms fails that have at most so many failures.
std::vector<std::size_t> seeds_without_failure(const League& league, std::size_t scenario, std::size_t most_failures) {
  std::vector<std::size_t> seeds;
  for (std::size_t k = 0; k < league.seeds; ++k) {
    bool failed = false;
    for (std::size_t a = 0; a < league.algorithms.size(); ++a)
      failed |= league.failed[league.first_run(scenario, a) + k] && league.failures(scenario, a) <= most_failures;
    if (!failed) seeds.push_back(k);
  }
  return seeds;
}

/// "completes", or with counts "completes 3; diverges 2", in the order of their first appearance.
std::string outcomes_text(std::span<const Result> runs) {
  std::vector<std::string_view> outcomes;
  for (const Result& run : runs) outcomes.push_back(outcome_name(run.end.outcome));
  std::vector<std::string> ways, texts;
  append_new(ways, {outcomes.begin(), outcomes.end()});
  if (ways.size() == 1) return ways.front();
  for (const std::string& way : ways) texts.push_back(fmt::format("{} {}", way, std::ranges::count(outcomes, way)));
  return fmt::format("{}", fmt::join(texts, "; "));
}

/// Without a rank.
Standing standing_of(const League& league, std::size_t s, std::size_t a, std::size_t m) {
  const std::size_t first = league.first_run(s, a);
  Standing standing{league.scenarios[s],   league.algorithms[a],
                    league.metrics[m],     league.seeds,
                    league.failures(s, a), outcomes_text(league.runs.subspan(first, league.seeds))};
  standing.common_seeds = league.common[s].size();
  standing.better = league.better[m];
  std::vector<double> numbers, tolerances;  // of the runs in the common seeds that did not fail
  for (const std::size_t k : league.common[s]) {
    const Metric* metric = find_metric(league.runs[first + k].metrics, standing.metric);
    if (metric == nullptr || league.failed[first + k]) continue;
    if (const auto value = number_of(metric->value)) numbers.push_back(*value);
    if (const auto tolerance = metric->tolerance()) tolerances.push_back(*tolerance);
  }
  if (!numbers.empty()) standing.mean = mean_of(numbers);
  if (!tolerances.empty()) standing.tolerance = mean_of(tolerances);
  if (numbers.size() >= 2 && league.seeds_matter[s]) standing.spread = standard_deviation(numbers);
  return standing;
}

bool is_better(const Standing& a, const Standing& b) {
  if (a.failed != b.failed) return a.failed < b.failed;
  if (a.failed > 0 || !a.mean) return false;
  if (!b.mean) return true;
  return a.better == Better::more ? is_less(b.number(), a.number()) : is_less(a.number(), b.number());
}

/// Standing::rank, from the standings of all algorithms.
std::optional<std::uint64_t> rank_of(const League& league, std::size_t s, std::size_t a, std::size_t m) {
  std::uint64_t rank = 1;
  bool has_mean = false;
  for (std::size_t other = 0; other < league.algorithms.size(); ++other) {
    if (is_better(league.at(s, other, m), league.at(s, a, m))) ++rank;
    has_mean |= league.at(s, other, m).mean.has_value();
  }
  return has_mean && league.better[m] != Better::none ? std::optional(rank) : std::nullopt;
}

LawStanding law_standing(const League& league, std::size_t a) {
  LawStanding law{league.algorithms[a], {}, {}};
  std::vector<double> ranks;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s) {
    for (std::size_t m = 0; m < league.metrics.size(); ++m)
      if (const auto rank = league.at(s, a, m).rank) ranks.push_back(static_cast<double>(*rank));
    if (league.failures(s, a) > 0) law.fails.push_back(league.scenarios[s]);
  }
  if (!ranks.empty()) law.mean_rank = mean_of(ranks);
  return law;
}

}  // namespace

Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter) {
  Axis axis{"seed"};
  Scenario own = scenario;
  for (std::size_t k = 0; k < seeds; ++k, ++own.seed) {
    axis.values.push_back(std::to_string(own.seed));
    if (jitter == 0.0) continue;
    const Vec3 start = own.initial.position + start_shift(own, jitter);
    axis.along.push_back({{fmt::format("initial.position_m=[{},{},{}]", start.x(), start.y(), start.z())}});
  }
  return axis;
}

fs::path Comparison::folder(std::size_t run) const {
  const fs::path folder = scene_folder(scene(run)) / algorithm(run);
  return seeds > 1 ? folder / fmt::format("seed_{}", run % seeds) : folder;
}

Comparison planned(const ComparisonQuestion& question) {
  const auto names = names_of_scenarios(question.scenarios);
  Comparison comparison{{}, names, question.algorithms, question.seeds};
  const std::size_t scenes = question.scenarios.size(), size = scenes * comparison.each();
  if (size > kMostRuns) {
    throw InputError(fmt::format("got {} scenarios x {} algorithms x {} seeds = {} runs; allowed: at most {}", scenes,
                                 question.algorithms.size(), question.seeds, size, kMostRuns));
  }
  for (const fs::path& file : question.scenarios)
    comparison.scenes.push_back(cases_of(question, file, comparison.warnings));
  return comparison;
}

std::vector<Result> run_all(std::span<const Cases> all, const JobOptions& jobs,
                            const std::function<fs::path(std::size_t)>& folder) {
  struct Run {
    const Cases& cases;
    std::size_t i, number;
  };
  std::vector<Run> runs;  // in their order
  for (const Cases& cases : all) {
    const std::size_t first = runs.size();
    for (std::size_t place = 0; place < cases.size(); ++place)
      runs.push_back({cases, cases.at(place), first + cases.at(place)});
  }
  std::vector<Result> results(runs.size());
  for_each_job(runs.size(), jobs, [&](std::size_t place) {
    const auto& [cases, i, number] = runs[place];
    results[number] =
        run_scenario(checked(cases.load(i)), folder ? std::optional(folder(number)) : std::nullopt, false);
    results[number].targets.clear();
  });
  return results;
}

void remove_earlier_comparison(const fs::path& folder, const Comparison& comparison) {
  std::error_code ignored;
  fs::remove(folder / "league.csv", ignored);
  for (std::size_t scene = 0; scene < comparison.scenes.size(); ++scene) {
    const fs::path place = folder / comparison.scene_folder(scene);
    fs::remove(place / "comparison.csv", ignored);
    for (const std::string& law : algorithm_names()) {
      std::vector<fs::path> runs;
      for (const auto& entry : fs::directory_iterator(place / law, ignored))
        if (entry.path().filename().string().starts_with("seed_")) runs.push_back(entry.path());
      runs.push_back(place / law);
      for (const fs::path& run : runs) {
        if (!fs::is_directory(run, ignored)) continue;
        remove_run(run);
        fs::remove(run, ignored);  // if it is empty now
      }
    }
  }
}

// ---- Means, and the league

double mean_of(const std::vector<double>& values) {
  if (values.empty()) return std::nan("");
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standard_deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double standard_error(const std::vector<double>& values) {
  return values.empty() ? 0.0 : standard_deviation(values) / std::sqrt(static_cast<double>(values.size()));
}

double paired_t(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() < 2) return 0.0;
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) differences.push_back(a[i] - b[i]);
  const double mean = mean_of(differences), error = standard_error(differences);
  if (error == 0.0) return mean == 0.0 ? 0.0 : std::copysign(std::numeric_limits<double>::infinity(), mean);
  return mean / error;
}

double critical_t(std::size_t degrees) {
  constexpr double kCritical[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  if (degrees == 0) return std::numeric_limits<double>::infinity();
  return kCritical[std::min(degrees, std::size(kCritical)) - 1];
}

bool is_less(const NumberWithError& a, const NumberWithError& b) {
  const double apart = *b.value - *a.value;
  return apart > *a.error + *b.error && apart > kSameRank * std::max(std::abs(*a.value), std::abs(*b.value));
}

std::size_t League::failures(std::size_t scenario, std::size_t algorithm) const {
  const auto first = failed.begin() + static_cast<std::ptrdiff_t>(first_run(scenario, algorithm));
  return static_cast<std::size_t>(std::count(first, first + static_cast<std::ptrdiff_t>(seeds), true));
}

void League::rank() {
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    bool matter = false;
    for (std::size_t a = 0; a < algorithms.size(); ++a)
      for (const Result& run : runs.subspan(first_run(s, a), seeds))
        matter |= run.state_hash != runs[first_run(s, a)].state_hash;
    seeds_matter.push_back(matter);
    common.push_back(seeds_without_failure(*this, s, seeds - 1));
    if (common.back().empty()) common.back() = seeds_without_failure(*this, s, 0);
    const std::size_t first = standings.size();
    for (std::size_t a = 0; a < algorithms.size(); ++a)
      for (std::size_t m = 0; m < metrics.size(); ++m) standings.push_back(standing_of(*this, s, a, m));
    for (std::size_t a = 0; a < algorithms.size(); ++a)
      for (std::size_t m = 0; m < metrics.size(); ++m)
        standings[first + a * metrics.size() + m].rank = rank_of(*this, s, a, m);
  }
  for (std::size_t a = 0; a < algorithms.size(); ++a) laws.push_back(law_standing(*this, a));
  std::ranges::stable_sort(laws, [](const LawStanding& a, const LawStanding& b) {
    return a.mean_rank && (!b.mean_rank || *a.mean_rank < *b.mean_rank);
  });
}

bool is_failure(std::string_view outcome) {
  const std::optional<Outcome> known = outcome_named(outcome);
  return known && outcome_infos()[static_cast<std::size_t>(*known)].is_failure;
}

bool have_reference(std::span<const Result> runs) {
  return std::ranges::all_of(runs, [](const Result& run) { return run.sections.contains("fidelity"); });
}

League league_of(const Comparison& comparison, std::span<const Result> reports,
                 const std::vector<std::string>& metrics) {
  const std::span<const std::string_view> usual =
      have_reference(reports) ? std::span<const std::string_view>(kFidelityMetrics) : kDefaultMetrics;
  League league{comparison.names, comparison.algorithms, metrics, {}, comparison.seeds, reports, {}};
  if (metrics.empty()) league.metrics.assign(usual.begin(), usual.end());
  for (const std::string& name : league.metrics) {
    const Metric* metric = find_metric(all_metrics(), name);
    league.better.push_back(metric == nullptr ? Better::none : metric->better);
  }
  for (const Result& summary : reports) {
    const Outcome outcome = summary.end.outcome;
    const Scenario scenario = comparison.load(league.failed.size()).scenario;
    // No law keeps a tool out that a script leads in: its force along the way is comparable all the same.
    const bool is_led = outcome == Outcome::went_through && !position_is_free(scenario.motion);
    const bool failed = is_failure(outcome_name(outcome)) || !outcome_is_expected(scenario.expect, outcome);
    league.failed.push_back(failed && !is_led);
  }
  league.rank();
  return league;
}

}  // namespace hapbench
