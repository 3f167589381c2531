#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/run_table.hpp"

namespace hapbench {
namespace {

/// By how much the mean may be wrong: by what its numbers may be, or by what another choice of seeds gives; more digits
/// than means of one rank have in common are not shown.
std::optional<double> error_of_mean(const Standing& standing) {
  if (!standing.spread) return standing.tolerance;
  const double of_seeds = *standing.spread / std::sqrt(static_cast<double>(standing.common_seeds));
  return std::max(
      {standing.tolerance, std::optional(of_seeds), std::optional(0.1 * kSameRank * std::abs(*standing.mean))});
}

}  // namespace

Columns<Standing> league_columns(bool seeds) {
  Columns<Standing> columns;
  columns.add("scenario", "", "name of the scenario", &Standing::scenario, {.heading = "scenario"});
  columns.add("algorithm", "", "force algorithm", &Standing::algorithm, {.heading = "algorithm"});
  columns.add("metric", "", "name of the metric; its unit is part of the name", &Standing::metric,
              {.heading = "metric"});
  columns.add("seeds", "1", "seeds of the algorithm in the scenario", &Standing::seeds);
  columns.add("failed", "1", "seeds that failed", &Standing::failed);
  columns.add("outcome", "", "how the runs ended; of several ways with their numbers", &Standing::outcome,
              {.heading = "how it ended"});
  columns.add("mean", "by name", "mean of the metric over the common seeds; empty when there is none", &Standing::mean,
              {.heading = "mean"}, error_of_mean);
  columns.add("spread", "by name",
              "standard deviation over these seeds; empty when there is one, or when seeds change nothing",
              &Standing::spread, {.heading = seeds ? "spread" : "", .digits = 2});
  columns.add(
      "rank", "1",
      "1 + the number of algorithms that did better in this scenario by this metric, by more than 0.1 % and both "
      "errors; those with failures are last, by the number of these",
      &Standing::rank, {.heading = "rank"});
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

namespace {

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
  Columns<LawStanding> columns;
  columns.add("algorithm", "", "", &LawStanding::algorithm, {.heading = "algorithm"});
  columns.add("mean_rank", "1",
              "mean of the algorithm's ranks over all metrics and scenarios, with those after failures",
              &LawStanding::mean_rank, {.heading = "mean rank", .digits = 3});
  columns.print("fails in", "", "scenarios in which a run failed", [](const LawStanding& l) {
    return l.fails.empty() ? "-" : fmt::format("{}", fmt::join(l.fails, ", "));
  });
  return columns;
}

/// Says which laws are first, alone or with others, in how many rankings.
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

/// Says who is first, and where no spread is known.
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

}  // namespace

std::string league_text(const League& league) {
  constexpr std::size_t kMostPrinted = 60;
  const std::string table =
      league.standings.size() <= kMostPrinted || output_is_in_full()
          ? league_columns(league.seeds > 1).table(ranked(league)).text()
          : fmt::format("{} standings are in league.csv; --wide prints them\n", league.standings.size());
  return fmt::format("{}\n{}\n{}", table, law_columns().table(league.laws).text(), verdict(league));
}

Json league_json(const League& league) {
  Json rows = Json::array(), laws = Json::array();
  const Columns<Standing> columns = league_columns(false);
  for (const Standing& standing : league.standings) rows.push_back(columns.json(standing));
  for (const LawStanding& law : league.laws) laws.emplace_back(law_columns().json(law))["fails"] = law.fails;
  return {{"standings", std::move(rows)}, {"laws", std::move(laws)}};
}

std::vector<DescribedTable> league_tables() {
  return {league_columns(true).described(
              "league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric"),
          law_columns().described()};
}

}  // namespace hapbench
