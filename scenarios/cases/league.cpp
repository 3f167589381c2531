#include "scenarios/cases/league.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "scenarios/format/metric_sections.hpp"

namespace hapbench {
namespace {

/// The seeds in which none of the algorithms fails that have at most so many failures.
std::vector<std::size_t> seeds_without_failure(const League& league, std::size_t scenario, std::size_t most_failures) {
  std::vector<std::size_t> seeds;
  for (std::size_t k = 0; k < league.seeds; ++k) {
    bool failed = false;
    for (std::size_t a = 0; a < league.algorithms.size(); ++a)
      failed |= league.runs_of(scenario, a)[k].failed && league.failures(scenario, a) <= most_failures;
    if (!failed) seeds.push_back(k);
  }
  return seeds;
}

/// Numbers of the runs in the common seeds that did not fail, as far as they have any.
std::vector<double> numbers_of(const League& league, std::size_t scenario, std::size_t algorithm, std::size_t metric,
                               std::vector<std::optional<double>> LeagueRun::*numbers) {
  std::vector<double> found;
  for (const std::size_t k : league.common[scenario]) {
    const LeagueRun& run = league.runs_of(scenario, algorithm)[k];
    if (const auto& number = (run.*numbers)[metric]; number && !run.failed) found.push_back(*number);
  }
  return found;
}

/// "completes", or with counts "completes 3; diverges 2", in the order of their first appearance.
std::string outcomes_text(std::span<const LeagueRun> runs) {
  std::vector<std::string> ways, texts;
  for (const LeagueRun& run : runs)
    if (std::ranges::find(ways, run.outcome) == ways.end()) ways.push_back(run.outcome);
  if (ways.size() == 1) return ways.front();
  for (const std::string& way : ways)
    texts.push_back(fmt::format("{} {}", way, std::ranges::count(runs, way, &LeagueRun::outcome)));
  return fmt::format("{}", fmt::join(texts, "; "));
}

/// Without a rank.
Standing standing_of(const League& league, std::size_t s, std::size_t a, std::size_t m) {
  Standing standing{league.scenarios[s], league.algorithms[a],  league.metrics[m],
                    league.seeds,        league.failures(s, a), outcomes_text(league.runs_of(s, a))};
  standing.common_seeds = league.common[s].size();
  standing.better = league.better[m];
  const std::vector<double> numbers = numbers_of(league, s, a, m, &LeagueRun::metrics),
                            tolerances = numbers_of(league, s, a, m, &LeagueRun::tolerances);
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

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
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
  return static_cast<std::size_t>(std::ranges::count_if(runs_of(scenario, algorithm), &LeagueRun::failed));
}

void League::rank() {
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    bool matter = false;
    for (std::size_t a = 0; a < algorithms.size(); ++a)
      for (const LeagueRun& run : runs_of(s, a)) matter |= run.state_hash != runs_of(s, a)[0].state_hash;
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
  return std::ranges::all_of(runs, [](const Result& run) { return run.has_section("fidelity"); });
}

League league_of(const Comparison& comparison, std::span<const Result> reports,
                 const std::vector<std::string>& metrics) {
  const std::span<const std::string_view> usual =
      have_reference(reports) ? std::span<const std::string_view>(kFidelityMetrics) : kDefaultMetrics;
  League league{comparison.names, comparison.algorithms, metrics, {}, comparison.seeds, {}};
  if (metrics.empty()) league.metrics.assign(usual.begin(), usual.end());
  for (const std::string& name : league.metrics) {
    const Metric* metric = find_metric(all_metrics(), name);
    league.better.push_back(metric == nullptr ? Better::none : metric->better);
  }
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const Result& summary = reports[i];
    const Outcome outcome = summary.end.outcome;
    const Scenario scenario = comparison.load(i).scenario;
    // No law keeps a tool out that a script leads in: its force along the way is comparable all the same.
    const bool is_led = outcome == Outcome::went_through && !position_is_free(scenario.motion);
    const bool failed = is_failure(outcome_name(outcome)) || !outcome_is_expected(scenario.expect, outcome);
    LeagueRun run{std::string(outcome_name(outcome)), failed && !is_led, summary.state_hash, {}, {}};
    for (const std::string& name : league.metrics) {
      const Metric* metric = find_metric(summary.metrics, name);
      run.metrics.push_back(metric == nullptr ? std::nullopt : number_of(metric->value));
      run.tolerances.push_back(metric == nullptr ? std::nullopt : metric->tolerance());
    }
    league.runs.push_back(std::move(run));
  }
  league.rank();
  return league;
}

}  // namespace hapbench
