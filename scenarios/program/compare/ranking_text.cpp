#include "scenarios/program/compare/ranking_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/program/compare/columns.hpp"
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
std::vector<RankingEntry> ranked(const Ranking& league) {
  std::vector<RankingEntry> all;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s) {
    for (std::size_t m = 0; m < league.metrics.size(); ++m) {
      const auto first = static_cast<std::ptrdiff_t>(all.size());
      for (std::size_t a = 0; a < league.algorithms.size(); ++a) all.push_back(league.at(s, a, m));
      std::stable_sort(all.begin() + first, all.end(), precedes_in_table);
    }
  }
  return all;
}

/// Number of rankings in which a law has a rank, and number of rankings in which it is first.
struct RankCount {
  std::size_t rankings = 0, first = 0;
};

RankCount rank_count(const Ranking& league, const std::string& algorithm) {
  RankCount count;
  for (const RankingEntry& standing : league.standings) {
    if (standing.algorithm != algorithm || !standing.rank) continue;
    ++count.rankings;
    if (*standing.rank == 1) ++count.first;
  }
  return count;
}

bool is_ranked(const Ranking& league) {
  return league.laws.front().mean_rank.has_value();
}

/// Returns why no algorithm has a rank.
const char* no_ranks_reason(const Ranking& league) {
  if (std::ranges::count(league.failed, false) == 0) return "every run failed";
  const auto has_direction = [](Better better) { return better != Better::none; };
  if (std::ranges::none_of(league.better, has_direction)) return "none of these metrics has a better direction";
  return "no successful run has a value of these metrics";
}

std::string first_ranks_text(const Ranking& league) {
  constexpr std::size_t kMaxNamed = 5;
  if (!is_ranked(league)) return std::string("nothing is ranked: ") + no_ranks_reason(league);
  std::size_t rankings = 0;
  std::vector<std::string> firsts;
  for (const LawRankingEntry& law : league.laws) {
    const RankCount count = rank_count(league, law.algorithm);
    rankings = std::max(rankings, count.rankings);  // smaller for kSharesReference
    if (count.first > 0) firsts.push_back(fmt::format("{} in {}", law.algorithm, count.first));
  }
  if (firsts.size() == 1)
    return fmt::format("{} alone has rank 1 in all {} rankings (scenario and metric)", league.laws.front().algorithm,
                       rankings);
  return fmt::format("no algorithm alone has rank 1 in all {} rankings (scenario and metric); times with rank 1: {}",
                     rankings, fmt::join(first_few(firsts, kMaxNamed), ", "));
}

/// Summarizes which algorithms are first, and whether the seeds give a spread.
std::string verdict(const Ranking& league, const Layout& layout) {
  const std::string text = layout.wrapped(first_ranks_text(league), 0);
  if (!is_ranked(league)) return text;
  if (league.seeds < 2) return text + "one seed: the spread is unknown; --seeds K estimates it\n";
  std::vector<std::string> alike;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s)
    if (!league.depends_on_seed[s]) alike.push_back(league.scenarios[s]);
  if (alike.empty()) return text + "\"hapbench report\" shows the differences between algorithms, seed by seed\n";
  return text +
         layout.wrapped(
             fmt::format(
                 "nothing is random in {}: all seeds give the same run, and the spread is unknown; --jitter METRES "
                 "shifts the start position of each seed",
                 fmt::join(alike, ", ")),
             0);
}

}  // namespace

std::string unranked_text(const Ranking& league, const Layout& layout) {
  const bool has_unranked = std::ranges::count(league.algorithms, kSharesReference) > 0 &&
                            std::ranges::count(league.is_rigid_reference, true) > 0;
  if (!has_unranked) return "";
  return layout.wrapped(
      fmt::format(
          "{} is not ranked by fidelity: it renders by the same constraints as the reference force, rigid contact",
          kSharesReference),
      0);
}

std::string ranking_text(const Ranking& league, const Layout& layout) {
  constexpr std::size_t kMaxPrinted = 60;
  const std::string table =
      league.standings.size() <= kMaxPrinted || layout.in_full()
          ? ranking_columns(league.seeds > 1).text(ranked(league), layout)
          : fmt::format("{} ranks are in ranking.csv; --wide prints them\n", league.standings.size());
  const std::string note =
      is_ranked(league)
          ? layout.wrapped("rank: 1 is best; equal ranks mean that the difference is within the errors or 0.1 %", 0)
          : "";
  return fmt::format("{}\n{}\n{}{}{}", table, law_ranking_columns().text(league.laws, layout), note,
                     unranked_text(league, layout), verdict(league, layout));
}

}  // namespace hapbench
