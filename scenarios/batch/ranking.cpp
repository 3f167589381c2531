#include "scenarios/batch/ranking.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "scenarios/batch/statistics.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

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
