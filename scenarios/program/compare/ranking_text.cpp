#include "scenarios/program/compare/ranking_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/shell_words.hpp"
#include "scenarios/program/compare/columns.hpp"
#include "scenarios/program/compare/law_metric_table.hpp"
#include "scenarios/program/names.hpp"

namespace hapbench {
namespace {

/// Returns true if row a precedes row b in the table: by rank, then by mean. Rows without a rank come last.
bool precedes_in_table(const RankingEntry& a, const RankingEntry& b) {
  if (a.rank != b.rank) return a.rank && (!b.rank || *a.rank < *b.rank);
  if (a.better == Better::none) return false;
  if (!a.mean || !b.mean) return a.mean && !b.mean;
  return a.better == Better::more ? *a.mean > *b.mean : *a.mean < *b.mean;
}

/// Returns the rankings by scenario and metric, each with the best algorithm first.
std::vector<RankingEntry> ranked(const Ranking& ranking) {
  std::vector<RankingEntry> all;
  for (std::size_t s = 0; s < ranking.scenarios.size(); ++s) {
    for (std::size_t m = 0; m < ranking.metrics.size(); ++m) {
      const auto first = static_cast<std::ptrdiff_t>(all.size());
      for (std::size_t a = 0; a < ranking.algorithms.size(); ++a) all.push_back(ranking.at(s, a, m));
      std::stable_sort(all.begin() + first, all.end(), precedes_in_table);
    }
  }
  return all;
}

/// Returns the number of pairs of scenario and metric in which at least one law has a rank.
std::size_t ranking_count(const Ranking& ranking) {
  std::set<std::pair<std::string, std::string>> rankings;
  for (const RankingEntry& entry : ranking.entries)
    if (entry.rank) rankings.emplace(entry.scenario, entry.metric);
  return rankings.size();
}

/// Returns the number of rankings in which a law is first.
std::size_t first_ranks(const Ranking& ranking, const std::string& algorithm) {
  return static_cast<std::size_t>(std::ranges::count_if(
      ranking.entries, [&](const RankingEntry& entry) { return entry.algorithm == algorithm && entry.rank == 1; }));
}

bool is_ranked(const Ranking& ranking) {
  return ranking.laws.front().mean_rank.has_value();
}

/// Returns why no algorithm has a rank.
const char* no_ranks_reason(const Ranking& ranking) {
  if (std::ranges::count(ranking.failed, false) == 0) return "every run failed";
  if (ranking.algorithms.size() == 1) return "there is only one law";
  const auto has_direction = [](Better better) { return better != Better::none; };
  if (std::ranges::none_of(ranking.better, has_direction))
    return "neither smaller nor larger values of these metrics are better";
  const auto has_mean = [](const RankingEntry& entry) { return entry.mean.has_value(); };
  if (std::ranges::none_of(ranking.entries, has_mean)) return "no successful run has a value of these metrics";
  return "each difference is below 0.1 %, or within the tolerance or the error of its metric";
}

std::string first_ranks_text(const Ranking& ranking) {
  constexpr std::size_t kMaxNamed = 5;
  if (!is_ranked(ranking)) return std::string("nothing is ranked: ") + no_ranks_reason(ranking);
  const std::size_t rankings = ranking_count(ranking);
  std::vector<std::string> firsts;
  bool is_everywhere = true;  // true if each law with a first rank is first in all rankings
  for (const LawRankingEntry& law : ranking.laws) {
    const std::size_t count = first_ranks(ranking, law.algorithm);
    if (count > 0) firsts.push_back(fmt::format("{} in {}", law.algorithm, count));
    is_everywhere = is_everywhere && (count == 0 || count == rankings);
  }
  if (firsts.empty())
    return "no algorithm has rank 1, because the error of the best mean is unknown or not smaller than the mean";
  const std::string where =
      rankings == 1 ? "" : fmt::format(" in all {} rankings (one per scenario and metric)", rankings);
  if (firsts.size() == 1 && is_everywhere)
    return fmt::format("{} alone is first{}", ranking.laws.front().algorithm, where);
  return fmt::format("no algorithm alone is first{}; first, ties included: {}", where,
                     fmt::join(first_few(firsts, kMaxNamed), ", "));
}

/// Returns true if, for each algorithm and metric in a scenario, the spread over the seeds is within the resolution of
/// the ranks.
bool seeds_agree(const Ranking& ranking, std::size_t scenario) {
  for (std::size_t a = 0; a < ranking.algorithms.size(); ++a) {
    for (std::size_t m = 0; m < ranking.metrics.size(); ++m) {
      const RankingEntry& entry = ranking.at(scenario, a, m);
      if (entry.mean && entry.spread && *entry.spread > kRankResolution * std::abs(*entry.mean)) return false;
    }
  }
  return true;
}

/// Returns sentences that say which algorithms are first, and whether the results of the runs depend on the seed.
std::string verdict(const Ranking& ranking, const std::string& folder, const Layout& layout) {
  std::string text = layout.wrapped(first_ranks_text(ranking), 0);
  if (ranking.seeds < 2)
    return is_ranked(ranking) ? text + "one seed: the spread is unknown; --seeds K estimates it\n" : text;
  std::vector<std::string> alike, agreeing;
  for (std::size_t s = 0; s < ranking.scenarios.size(); ++s) {
    if (!ranking.depends_on_seed[s])
      alike.push_back(ranking.scenarios[s]);
    else if (seeds_agree(ranking, s))
      agreeing.push_back(ranking.scenarios[s]);
  }
  if (!agreeing.empty())
    text += layout.wrapped(
        fmt::format(
            "the results of all seeds of {} agree within 0.1 %: the spread does not estimate the error of the numbers; "
            "--errors estimates this error",
            fmt::join(agreeing, ", ")),
        0);
  if (alike.empty() && !is_ranked(ranking)) return text;
  if (alike.empty())
    return text + layout.wrapped(fmt::format("\"hapbench report {}\" compares the algorithms in pairs, seed by seed",
                                             shell_file(folder)),
                                 0);
  return text +
         layout.wrapped(
             fmt::format(
                 "nothing is random in {}: all seeds give the same run, and the spread is unknown; --jitter METRES "
                 "shifts the start position of each seed",
                 fmt::join(alike, ", ")),
             0);
}

}  // namespace

std::string unranked_text(const Ranking& ranking, const Layout& layout) {
  const bool has_unranked = std::ranges::count(ranking.algorithms, kSharesReference) > 0 &&
                            std::ranges::count(ranking.is_rigid_reference, true) > 0;
  if (!has_unranked) return "";
  return layout.wrapped(
      fmt::format(
          "{} is not ranked by fidelity: it renders by the same constraints as the reference force (rigid contact)",
          kSharesReference),
      0);
}

/// Returns a line for each scenario whose means are not over all seeds.
static std::string common_seeds_text(const Ranking& ranking, const Layout& layout) {
  std::string text;
  for (std::size_t s = 0; s < ranking.scenarios.size(); ++s)
    if (const std::string seeds = seeds_of_means_text(ranking, s); !seeds.empty())
      text += layout.wrapped(fmt::format("mean and spread in {}: {}; algorithms that failed in every seed are ignored",
                                         ranking.scenarios[s], seeds),
                             0);
  return text;
}

void report_ranking_text(const Ranking& ranking, const Layout& layout, Report& report) {
  if (report.prints_tables()) return report.show(law_metric_table(ranking));
  constexpr std::size_t kMaxPrinted = 60;
  if (ranking.entries.size() <= kMaxPrinted || layout.in_full()) {
    report.show(ranking_columns(ranking.seeds > 1).table(ranked(ranking), "ranks", layout.in_full()));
  } else {
    report.add_text(fmt::format("{} ranks are in ranking.csv; --wide prints them\n", ranking.entries.size()));
  }
  report.add_text("\n");
  report.show(law_ranking_columns().table(ranking.laws, "mean ranks", layout.in_full()));
  report.add_text("\n");
  if (is_ranked(ranking))
    report.add_text(layout.wrapped(
        fmt::format(
            "rank: 1 is best. Algorithms share a rank if their means differ by at most 0.1 % or by at most the "
            "sum of their errors{}{}{}. No rank (-): the error of the mean is unknown; or it is not smaller than the "
            "mean, so that only a bound of the mean (<=) is known; or all ranks would be equal",
            ranking.estimated_error ? ", which are estimated below"
                                    : "; the errors of time step and point spacing do not count (--errors)",
            ranking.seeds > 1 ? "; the spread over the seeds does not count" : "",
            std::ranges::count(ranking.failed, true) > 0 ? ". An algorithm with failed runs ranks after all others"
                                                         : ""),
        0));
  if (ranking.seeds > 1)
    report.add_text("spread: standard deviation over the seeds (random numbers of noise, tremor and --jitter)\n");
  report.add_text(common_seeds_text(ranking, layout));
  report.add_text(unranked_text(ranking, layout));
  report.add_text(verdict(ranking, report.folder().string(), layout));
}

}  // namespace hapbench
