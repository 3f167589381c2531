#include "scenarios/program/league_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenarios/program/index.hpp"

namespace hapbench {
namespace {

/// "A" ... "Z", "AA", "AB", ...: short names for scenarios.
std::string letter(std::size_t scenario) {
  const std::string last(1, static_cast<char>('A' + scenario % 26));
  return scenario < 26 ? last : letter(scenario / 26 - 1) + last;
}

std::string letters(const std::vector<std::size_t>& scenarios) {
  std::vector<std::string> texts;
  for (const std::size_t scenario : scenarios) texts.push_back(letter(scenario));
  return fmt::format("{}", fmt::join(texts, " "));
}

/// By how much the mean may be wrong: by what its numbers may be, or by what another choice of seeds gives.
std::optional<double> mean_error(const Standing& standing) {
  if (!standing.spread) return standing.tolerance;
  const double of_seeds = *standing.spread / std::sqrt(static_cast<double>(standing.common_seeds));
  return std::max(standing.tolerance, std::optional(of_seeds));
}

std::string rank_text(const Standing& standing) {
  return standing.rank ? fmt::format("{}{}", *standing.rank, standing.failed > 0 ? 'x' : ' ') : "- ";
}

std::string mean_text(const Standing& standing) {
  return standing.mean ? deserved(*standing.mean, mean_error(standing)) : "-";
}

/// A row is the standings of an algorithm by one metric in each scenario.
using StandingsRow = std::vector<const Standing*>;

/// `with_spread`: also mean and spread of each scenario.
Columns<StandingsRow> standings_columns(std::size_t scenarios, bool with_spread) {
  Columns<StandingsRow> columns;
  columns.print("algorithm", "", "", [](const StandingsRow& r) { return r[0]->algorithm; });
  for (std::size_t s = 0; s < scenarios; ++s) {
    columns.print(scenarios > 1 ? letter(s) + " " : "rank ", "1",
                  scenarios > 1
                      ? "of compare: rank in the scenario that has this letter above the table; x: a run failed"
                      : "rank",
                  [s](const StandingsRow& r) { return rank_text(*r[s]); });
    if (!with_spread) continue;
    columns.print("mean", "1", "mean", [s](const StandingsRow& r) { return mean_text(*r[s]); });
    columns.print("spread", "1", "spread", [s](const StandingsRow& r) { return significant(r[s]->spread, 2); });
  }
  return columns;
}

std::string standings_text(const League& league, std::size_t metric) {
  const std::size_t scenarios = league.scenarios.size();
  std::vector<StandingsRow> rows(league.algorithms.size());
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t s = 0; s < scenarios; ++s) rows[a].push_back(&league.at(s, a, metric));
  const Table table = standings_columns(scenarios, true).table(rows);
  return table.width() <= prose_width() ? table.text()
                                        : standings_columns(scenarios, false).table(rows).text(prose_width());
}

Columns<LawStanding> mean_rank_columns() {
  Columns<LawStanding> columns;
  columns.print("algorithm", "", "", &LawStanding::algorithm);
  columns.print("mean rank", "1",
                "mean of the algorithm's ranks over all metrics and scenarios, with those after failures",
                [](const LawStanding& l) { return significant(l.mean_rank, 3); });
  columns.print("fails", "", "letters of the scenarios in which a run failed",
                [](const LawStanding& l) { return letters(l.fails); });
  return columns;
}

/// Says where no spread is known, and why.
std::string spread_text(const League& league) {
  if (league.seeds < 2) return "one seed: no spread is known; --seeds K gives one\n";
  std::vector<std::size_t> alike;
  for (std::size_t s = 0; s < league.seeds_matter.size(); ++s) {
    if (!league.seeds_matter[s]) alike.push_back(s);
  }
  if (alike.empty()) return "\"hapbench report\" says what lies between laws, seed by seed\n";
  return fmt::format(
      "nothing is random in {}: all seeds are one run, no spread is known; --jitter METRES shifts the start\n",
      letters(alike));
}

/// Names the seeds that the means are over, in a scenario in which some runs failed.
std::string failed_seeds_text(const League& league, std::size_t scenario) {
  std::vector<std::string> failed;
  for (std::size_t a = 0; a < league.algorithms.size(); ++a) {
    const std::size_t failures = league.failures(scenario, a);
    if (failures > 0 && failures < league.seeds) failed.push_back(fmt::format("{} {}", league.algorithms[a], failures));
  }
  if (failed.empty()) return "";
  return fmt::format("\n   means over {} of {} seeds; failed: {}", league.common[scenario].size(), league.seeds,
                     fmt::join(failed, ", "));
}

}  // namespace

Columns<Standing> league_columns() {
  Columns<Standing> columns;
  columns.add("scenario", "", "name of the scenario", &Standing::scenario);
  columns.add("algorithm", "", "force algorithm", &Standing::algorithm);
  columns.add("metric", "", "name of the metric; its unit is part of the name", &Standing::metric);
  columns.add("seeds", "1", "seeds of the algorithm in the scenario", &Standing::seeds);
  columns.add("failed", "1", "seeds that failed", &Standing::failed);
  columns.add("outcome", "", "how the runs ended; of several ways with their numbers", &Standing::outcome);
  columns.add("mean", "by name", "mean of the metric over the common seeds; empty when there is none", &Standing::mean);
  columns.add("spread", "by name",
              "standard deviation over these seeds; empty when there is one, or when seeds change nothing",
              &Standing::spread);
  columns.add(
      "rank", "1",
      "1 + the number of algorithms that did better in this scenario by this metric; those with failures are last",
      &Standing::rank);
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

std::string league_text(const League& league) {
  std::string text;
  for (std::size_t s = 0; s < league.scenarios.size(); ++s)
    text += fmt::format("{}  {}{}\n", letter(s), league.scenarios[s], failed_seeds_text(league, s));
  for (std::size_t m = 0; m < league.metrics.size(); ++m) {
    const Better better = league.better[m];
    text += fmt::format("\n{}, {}\n\n{}", league.metrics[m],
                        better == Better::less   ? "less is better"
                        : better == Better::more ? "more is better"
                                                 : "neither less nor more is better: not ranked",
                        standings_text(league, m));
  }
  return text + fmt::format(
                    "\nall metrics and scenarios\n\n{}\n"
                    "Means closer than {} % share a rank. x: a run failed; it ranks behind all that did not, by the\n"
                    "number of failures; of the others those without such a number are last.\n{}",
                    mean_rank_columns().table(league.laws).text(), 100.0 * kSameRank, spread_text(league));
}

Json league_json(const League& league) {
  Json rows = Json::array(), laws = Json::array();
  const Columns<Standing> columns = league_columns();
  for (const Standing& standing : league.standings) rows.push_back(columns.json(standing));
  for (const LawStanding& law : league.laws) {
    std::vector<std::string> fails;
    for (const std::size_t scenario : law.fails) fails.push_back(league.scenarios[scenario]);
    laws.push_back({{"algorithm", law.algorithm}, {"mean_rank", or_null(law.mean_rank)}, {"fails", fails}});
  }
  return {{"standings", std::move(rows)}, {"laws", std::move(laws)}};
}

std::vector<DescribedTable> league_tables() {
  return {league_columns().described(
              "league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric"),
          standings_columns(26, false).described(), standings_columns(1, true).described(),
          mean_rank_columns().described()};
}

}  // namespace hapbench
