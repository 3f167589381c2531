#include "scenarios/program/league_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <map>

#include "scenarios/program/table.hpp"

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

std::string number(const std::optional<double>& value, int digits) {
  return significant(value.value_or(std::numeric_limits<double>::quiet_NaN()), digits);
}

/// How much of a standing a table shows.
enum class Detail { rank, ratio, spread };

/// The rank and a sign: failed, beyond the spread, within it, or nothing known.
std::string rank_cell(const Standing& standing, bool failed) {
  const char sign = failed ? 'x' : !standing.beyond_spread ? ' ' : *standing.beyond_spread ? '*' : '~';
  return standing.rank ? fmt::format("{}{}", *standing.rank, sign) : "- ";
}

std::vector<Table::Column> standing_columns(const League& league, Detail detail) {
  const std::size_t scenarios = league.runs.scenarios.size();
  std::vector<Table::Column> columns = {{"algorithm", false}};
  for (std::size_t s = 0; s < scenarios; ++s) {
    columns.push_back({scenarios > 1 ? letter(s) + " " : "rank "});
    if (detail == Detail::rank) continue;
    columns.push_back({"ratio"});
    if (detail == Detail::spread) columns.insert(columns.end(), {{"mean"}, {"spread"}});
  }
  return columns;
}

Table standings(const League& league, std::size_t metric, Detail detail) {
  Table table(standing_columns(league, detail));
  for (std::size_t a = 0; a < league.runs.algorithms.size(); ++a) {
    std::vector<std::string> cells = {league.runs.algorithms[a]};
    for (std::size_t s = 0; s < league.runs.scenarios.size(); ++s) {
      const Standing& standing = league.at(s, a, metric);
      cells.push_back(rank_cell(standing, league.failures(s, a) > 0));
      if (detail == Detail::rank) continue;
      cells.push_back(number(standing.ratio_to_best, 3));
      if (detail == Detail::spread) {
        cells.insert(cells.end(), {number(standing.mean, 4), number(standing.spread, 2)});
      }
    }
    table.add(std::move(cells));
  }
  return table;
}

std::string standings_text(const League& league, std::size_t metric) {
  for (const Detail detail : {Detail::spread, Detail::ratio}) {
    const Table table = standings(league, metric, detail);
    if (table.width() <= prose_width()) return table.text();
  }
  return standings(league, metric, Detail::rank).text(prose_width());
}

/// "diverges B D; leaves_hole A", or without the scenarios where that is long: "diverges 12; leaves_hole 7".
std::string fails_text(const League& league, const LawStanding& law) {
  std::map<std::string, std::vector<std::size_t>> scenarios;
  for (const std::size_t s : law.fails) {
    for (std::size_t k = 0; k < league.runs.seeds; ++k) {
      const LeagueRun& run = league.runs.run(s, law.algorithm, k);
      auto& known = scenarios[run.outcome];
      if (run.failed && (known.empty() || known.back() != s)) known.push_back(s);
    }
  }
  std::vector<std::string> texts, counts;
  for (const auto& [outcome, where] : scenarios) {
    if (where.empty()) continue;
    texts.push_back(fmt::format("{} {}", outcome, letters(where)));
    counts.push_back(fmt::format("{} {}", outcome, where.size()));
  }
  constexpr std::size_t kLongest = 30;
  const std::string text = fmt::format("{}", fmt::join(texts, "; "));
  return text.size() <= kLongest ? text : fmt::format("{}", fmt::join(counts, "; "));
}

std::string laws_text(const League& league) {
  constexpr std::size_t kMostLetters = 12;
  Table table({{"algorithm", false}, {"mean rank"}, {"ratio"}, {"of"}, {"wins", false}, {"fails", false}});
  for (const LawStanding& law : league.laws) {
    table.add({league.runs.algorithms[law.algorithm], number(law.mean_rank, 3), number(law.mean_ratio, 3),
               std::to_string(law.ratios),
               law.wins.size() <= kMostLetters ? letters(law.wins) : std::to_string(law.wins.size()),
               fails_text(league, law)});
  }
  return table.text();
}

/// What is known of the spread, and by which rule.
std::string spread_text(const League& league) {
  if (league.runs.seeds < 2) return "one seed: no spread is known; --seeds K gives one\n";
  std::vector<std::size_t> alike;
  for (std::size_t s = 0; s < league.seeds_matter.size(); ++s) {
    if (!league.seeds_matter[s]) alike.push_back(s);
  }
  std::string text;
  if (alike.size() < league.seeds_matter.size()) {
    text = fmt::format(
        "* differs from the best by more than the spread over {} seeds, ~ does not: t of the differences\n"
        "seed by seed (each seed gives all the same start and noise) against its 5 % quantile, two-sided\n",
        league.runs.seeds);
  }
  if (!alike.empty()) {
    text += fmt::format(
        "nothing is random in {}: all seeds are one run, no spread is known; --jitter METRES shifts the start\n",
        letters(alike));
  }
  return text;
}

}  // namespace

std::string league_text(const League& league) {
  std::string text;
  const std::size_t scenarios = league.runs.scenarios.size();
  for (std::size_t s = 0; s < scenarios; ++s) text += fmt::format("{}  {}\n", letter(s), league.runs.scenarios[s]);
  for (std::size_t m = 0; m < league.runs.metrics.size(); ++m) {
    text += fmt::format("\n{}, less is better\n\n{}", league.runs.metrics[m], standings_text(league, m));
  }
  return text +
         fmt::format(
             "\nall metrics and scenarios\n\n{}\n"
             "ratio: to the best; in the last table the geometric mean of so many. wins: no other has a better\nmean rank "
             "there. Closer than {} % share a rank. x: a run failed; it ranks behind all that did not,\nand of "
             "those the ones without such a number last.\n{}",
             laws_text(league), 100.0 * kSameRank, spread_text(league));
}

}  // namespace hapbench
