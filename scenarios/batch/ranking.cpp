#include "scenarios/batch/ranking.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "scenarios/batch/statistics.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

/// Returns the seeds for which no algorithm fails. Algorithms with more than `max_failures` failures are
/// ignored.
std::vector<std::size_t> seeds_without_failure(const Ranking& ranking, std::size_t scenario, std::size_t max_failures) {
  std::vector<std::size_t> seeds;
  for (std::size_t k = 0; k < ranking.seeds; ++k) {
    bool failed = false;
    for (std::size_t a = 0; a < ranking.algorithms.size(); ++a)
      failed |= ranking.failed[ranking.first_run(scenario, a) + k] && ranking.failures(scenario, a) <= max_failures;
    if (!failed) seeds.push_back(k);
  }
  return seeds;
}

/// Returns how runs ended. If all outcomes are equal, returns the outcome, such as "completes". Otherwise returns each
/// outcome with its count, such as "completes 3; diverges 2", in the order of their first appearance.
std::string outcomes_text(std::span<const Result> runs) {
  std::vector<std::string_view> outcomes;
  for (const Result& run : runs) outcomes.push_back(outcome_name(run.end.outcome));
  std::vector<std::string> distinct, texts;
  append_new(distinct, {outcomes.begin(), outcomes.end()});
  if (distinct.size() == 1) return distinct.front();
  for (const std::string& outcome : distinct)
    texts.push_back(fmt::format("{} {}", outcome, std::ranges::count(outcomes, outcome)));
  return fmt::format("{}", fmt::join(texts, "; "));
}

/// Returns the result of algorithm a in scenario s for metric m, without its rank.
RankingEntry ranking_entry(const Ranking& ranking, std::size_t s, std::size_t a, std::size_t m) {
  const std::size_t first = ranking.first_run(s, a);
  RankingEntry entry{ranking.scenarios[s],   ranking.algorithms[a],
                     ranking.metrics[m],     ranking.seeds,
                     ranking.failures(s, a), outcomes_text(ranking.runs.subspan(first, ranking.seeds))};
  entry.common_seeds = ranking.lacks_common_seeds(s) ? entry.seeds - entry.failed : ranking.common[s].size();
  entry.better = ranking.better[m];
  std::vector<double> numbers, tolerances;  // values of successful runs with common seeds
  for (const std::size_t k : ranking.common[s]) {
    const Metric* metric = find_metric(ranking.runs[first + k].metrics, entry.metric);
    if (metric == nullptr || ranking.failed[first + k]) continue;
    const auto value = number_of(metric->value);
    if (value) numbers.push_back(*value);
    if (const auto tolerance = metric->tolerance(); tolerance && !ranking.estimated_error)
      tolerances.push_back(*tolerance);
    if (!value || !ranking.estimated_error) continue;
    const auto error = ranking.estimated_error(first + k, entry.metric);
    entry.has_known_error = entry.has_known_error && error;
    if (error) tolerances.push_back(*error);
  }
  if (!numbers.empty()) entry.mean = mean_of(numbers);
  if (!tolerances.empty()) entry.tolerance = mean_of(tolerances);
  if (numbers.size() >= 2 && ranking.depends_on_seed[s]) entry.spread = standard_deviation(numbers);
  return entry;
}

/// Returns true if `a` ranks before `b` (RankingEntry::rank).
bool is_better(const RankingEntry& a, const RankingEntry& b) {
  if (a.failed != b.failed) return a.failed < b.failed;
  if (a.failed > 0 || !a.mean) return false;
  if (!b.mean) return true;
  return a.better == Better::more ? is_less(b.number(), a.number()) : is_less(a.number(), b.number());
}

/// Returns RankingEntry::rank of algorithm a in scenario s for metric m. Precondition: the entries of all
/// algorithms exist.
std::optional<std::uint64_t> rank_of(const Ranking& ranking, std::size_t s, std::size_t a, std::size_t m) {
  if (ranking.shares_reference(s, a, m)) return std::nullopt;
  std::uint64_t rank = 1;
  bool has_mean = false;
  for (std::size_t other = 0; other < ranking.algorithms.size(); ++other) {
    if (ranking.shares_reference(s, other, m)) continue;
    if (is_better(ranking.at(s, other, m), ranking.at(s, a, m))) ++rank;
    has_mean |= ranking.at(s, other, m).mean.has_value();
  }
  return has_mean && ranking.better[m] != Better::none ? std::optional(rank) : std::nullopt;
}

/// Removes the ranks in scenario s for metric m that the errors do not allow: the rank of an algorithm whose mean is
/// only bounded or has an unknown error, and all ranks if they are equal.
void remove_unfounded_ranks(Ranking& ranking, std::size_t s, std::size_t m) {
  std::set<std::uint64_t> ranks;
  const std::size_t first = s * ranking.algorithms.size();
  const auto entry = [&](std::size_t a) -> RankingEntry& {
    return ranking.entries[(first + a) * ranking.metrics.size() + m];
  };
  for (std::size_t a = 0; a < ranking.algorithms.size(); ++a) {
    RankingEntry& own = entry(a);
    if (own.failed == 0 && (!own.has_known_error || is_only_bounded({own.mean, own.tolerance}))) own.rank.reset();
    if (own.rank) ranks.insert(*own.rank);
  }
  for (std::size_t a = 0; a < ranking.algorithms.size() && ranks.size() < 2; ++a) entry(a).rank.reset();
}

/// Returns the result of algorithm a over all scenarios and metrics.
LawRankingEntry law_ranking_entry(const Ranking& ranking, std::size_t a) {
  LawRankingEntry law{ranking.algorithms[a], {}, {}};
  std::vector<double> ranks;
  for (std::size_t s = 0; s < ranking.scenarios.size(); ++s) {
    for (std::size_t m = 0; m < ranking.metrics.size(); ++m)
      if (const auto rank = ranking.at(s, a, m).rank) ranks.push_back(static_cast<double>(*rank));
    if (ranking.failures(s, a) > 0) law.fails.push_back(ranking.scenarios[s]);
  }
  if (!ranks.empty()) law.mean_rank = mean_of(ranks);
  return law;
}

}  // namespace

std::size_t Ranking::failures(std::size_t scenario, std::size_t algorithm) const {
  const auto first = failed.begin() + static_cast<std::ptrdiff_t>(first_run(scenario, algorithm));
  return static_cast<std::size_t>(std::count(first, first + static_cast<std::ptrdiff_t>(seeds), true));
}

bool Ranking::shares_reference(std::size_t scenario, std::size_t algorithm, std::size_t metric) const {
  return !is_rigid_reference.empty() && is_rigid_reference[scenario] && algorithms[algorithm] == kSharesReference &&
         metrics[metric].starts_with("fidelity.");
}

bool Ranking::seeds_matter(std::size_t scenario) const {
  for (std::size_t a = 0; a < algorithms.size(); ++a) {
    const auto same = runs.subspan(first_run(scenario, a), seeds);
    if (std::ranges::any_of(same, [&](const Result& run) { return run.state_hash != same.front().state_hash; }))
      return true;
  }
  return false;
}

bool Ranking::lacks_common_seeds(std::size_t scenario) const {
  if (common[scenario].size() < seeds) return false;
  for (std::size_t a = 0; a < algorithms.size(); ++a)
    if (const std::size_t failed_seeds = failures(scenario, a); failed_seeds > 0 && failed_seeds < seeds) return true;
  return false;
}

void Ranking::rank() {
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    depends_on_seed.push_back(seeds_matter(s));
    // Choose the seeds over which means are computed.
    common.push_back(seeds_without_failure(*this, s, seeds - 1));
    if (common.back().empty()) common.back() = seeds_without_failure(*this, s, 0);
    // Compute the mean of each algorithm and metric, then rank the means.
    const std::size_t first = entries.size();
    for (std::size_t a = 0; a < algorithms.size(); ++a)
      for (std::size_t m = 0; m < metrics.size(); ++m) entries.push_back(ranking_entry(*this, s, a, m));
    for (std::size_t a = 0; a < algorithms.size(); ++a)
      for (std::size_t m = 0; m < metrics.size(); ++m)
        entries[first + a * metrics.size() + m].rank = rank_of(*this, s, a, m);
    for (std::size_t m = 0; m < metrics.size(); ++m) remove_unfounded_ranks(*this, s, m);
  }
  // Rank the algorithms over all scenarios.
  for (std::size_t a = 0; a < algorithms.size(); ++a) laws.push_back(law_ranking_entry(*this, a));
  std::ranges::stable_sort(laws, [](const LawRankingEntry& a, const LawRankingEntry& b) {
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

Ranking rank_comparison(const Comparison& comparison, std::span<const Result> reports,
                        const std::vector<std::string>& metrics, const EstimatedError& estimated_error) {
  const std::span<const std::string_view> defaults =
      have_reference(reports) ? std::span<const std::string_view>(kFidelityMetrics) : kDefaultMetrics;
  Ranking ranking{comparison.names, comparison.algorithms, metrics, {}, comparison.seeds, reports, {}};
  ranking.estimated_error = estimated_error;
  if (metrics.empty()) ranking.metrics.assign(defaults.begin(), defaults.end());
  // Find out for each metric whether smaller or larger values are better.
  for (const std::string& name : ranking.metrics) {
    const Metric* metric = find_metric(all_metrics(), name);
    ranking.better.push_back(metric == nullptr ? Better::none : metric->better);
  }
  for (std::size_t s = 0; s < comparison.scenes.size(); ++s) {
    const auto& reference = comparison.load(s * comparison.each()).scenario.reference_force;
    ranking.is_rigid_reference.push_back(reference && std::holds_alternative<RigidContactFields>(*reference));
  }
  // Find the runs that failed.
  for (const Result& summary : reports) {
    const Outcome outcome = summary.end.outcome;
    const Scenario scenario = comparison.load(ranking.failed.size()).scenario;
    // If a script leads the tool through the surface, the run has not failed: no force law can prevent this, and the
    // forces on the path are still comparable.
    const bool is_led = outcome == Outcome::went_through && !position_is_free(scenario.motion);
    const bool failed = is_failure(outcome_name(outcome)) || !outcome_is_expected(scenario.expect, outcome);
    ranking.failed.push_back(failed && !is_led);
  }
  ranking.rank();
  return ranking;
}

}  // namespace hapbench
