#include "scenarios/program/league_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/program/index.hpp"

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
  columns.add("rank", "1",
              "1 + the number of algorithms that did better in this scenario by this metric, where means within 0.1 % "
              "are equal; those with failures are last, by the number of these",
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

/// The standings of a metric in a scenario, best first, those without a rank last.
std::vector<Standing> ranked(const League& league, std::size_t scenario, std::size_t metric) {
  std::vector<Standing> standings;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a) standings.push_back(league.at(scenario, a, metric));
  std::ranges::stable_sort(standings, {}, [](const Standing& s) { return s.rank.value_or(s.seeds + 100'000); });
  return standings;
}

std::vector<std::string> scenes_of_failures(const League& league, const LawStanding& law) {
  std::vector<std::string> names;
  for (const std::size_t scenario : law.fails) names.push_back(league.scenarios[scenario]);
  return names;
}

Columns<LawStanding> law_columns(const League& league) {
  Columns<LawStanding> columns;
  columns.add("algorithm", "", "", &LawStanding::algorithm, {.heading = "algorithm"});
  columns.add("mean_rank", "1",
              "mean of the algorithm's ranks over all metrics and scenarios, with those after failures",
              &LawStanding::mean_rank, {.heading = "mean rank", .digits = 3});
  columns.print("fails in", "", "scenarios in which a run failed", [&league](const LawStanding& l) {
    return l.fails.empty() ? "-" : fmt::format("{}", fmt::join(scenes_of_failures(league, l), ", "));
  });
  return columns;
}

/// Says where no spread is known, or over which seeds the means are.
std::string seeds_text(const League& league) {
  if (league.seeds < 2) return "one seed: no spread is known; --seeds K gives one\n";
  std::vector<std::string> alike;
  for (std::size_t s = 0; s < league.seeds_matter.size(); ++s)
    if (!league.seeds_matter[s]) alike.push_back(league.scenarios[s]);
  std::string text;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s) {
    const std::size_t common = league.common[s].size();
    if (common < league.seeds)
      text += fmt::format("{}: means over {} of {} seeds, as runs failed\n", league.scenarios[s], common, league.seeds);
  }
  if (alike.empty()) return text + "\"hapbench report\" says what lies between laws, seed by seed\n";
  return text + wrapped(fmt::format("nothing is random in {}: all seeds are one run, no spread is known; --jitter "
                                    "METRES shifts the start",
                                    fmt::join(alike, ", ")),
                        0);
}

/// Says of a league whether one law is first by all metrics.
std::string league_verdict(const League& league) {
  const LawStanding& best = league.laws.front();
  if (league.laws.size() < 2) return "";
  if (!best.mean_rank) return "nothing is ranked: neither less nor more of these metrics is better\n";
  std::size_t rankings = 0, first = 0;
  for (const Standing& standing : league.standings) {
    if (standing.algorithm != best.algorithm || !standing.rank) continue;
    ++rankings;
    first += *standing.rank == 1;
  }
  if (first == rankings)
    return fmt::format("{} is first{}\n", best.algorithm,
                       rankings > 1 ? fmt::format(" in all {} rankings", rankings) : "");
  return fmt::format("not decided: {} has the best mean rank, but is first in {} of {} rankings\n", best.algorithm,
                     first, rankings);
}

}  // namespace

std::string league_text(const League& league) {
  constexpr std::size_t kMostPrinted = 60;
  std::string text;
  if (league.standings.size() <= kMostPrinted || output_is_in_full()) {
    std::vector<Standing> rows;
    for (std::size_t s = 0; s < league.scenarios.size(); ++s) {
      for (std::size_t m = 0; m < league.metrics.size(); ++m) {
        const std::vector<Standing> order = ranked(league, s, m);
        rows.insert(rows.end(), order.begin(), order.end());
      }
    }
    text = league_columns(league.seeds > 1).table(rows).text() + "\n";
  } else {
    text = fmt::format("{} standings are in league.csv; --wide prints them\n\n", league.standings.size());
  }
  return text + law_columns(league).table(league.laws).text() + "\n" + league_verdict(league) + seeds_text(league);
}

Json league_json(const League& league) {
  Json rows = Json::array(), laws = Json::array();
  const Columns<Standing> columns = league_columns(false);
  for (const Standing& standing : league.standings) rows.push_back(columns.json(standing));
  const Columns<LawStanding> columns_of_laws = law_columns(league);
  for (const LawStanding& law : league.laws)
    laws.emplace_back(columns_of_laws.json(law))["fails"] = scenes_of_failures(league, law);
  return {{"standings", std::move(rows)}, {"laws", std::move(laws)}};
}

std::vector<DescribedTable> league_tables() {
  return {league_columns(true).described(
              "league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric"),
          law_columns({}).described()};
}

}  // namespace hapbench
