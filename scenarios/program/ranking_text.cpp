#include "scenarios/program/ranking_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

std::string moved_text(const RankingCheck& check, const RankingColumn& column, std::size_t law) {
  const auto number = [](const std::optional<double>& value, const std::optional<double>& tolerance) {
    return value ? significant(*value, deserved_digits(*value, tolerance, 3)) : "none";
  };
  return fmt::format("{} {} -> {}", check.algorithms[law], number(column.before[law], column.tolerance_before[law]),
                     number(column.after[law], column.tolerance_after[law]));
}

/// The numbers behind a verdict.
std::string numbers_text(const RankingCheck& check, const RankingColumn& column) {
  if (column.metric.empty()) return column.change;
  const ColumnVerdict& verdict = column.verdict;
  std::string text = moved_text(check, column, verdict.law);
  if (verdict.other) {
    text += ", " + moved_text(check, column, *verdict.other);
  } else {
    const auto &before = column.before[verdict.law], &after = column.after[verdict.law];
    if (before == after) return "nothing moves";
    if (before && after) {
      const double moved = std::abs(*after - *before) / std::max(std::abs(*after), std::abs(*before));
      if (moved < kSameRank) return fmt::format("nothing moves by {:g} %", 100.0 * kSameRank);
      text = fmt::format("at most {:.1f} %: {}", 100.0 * moved, text);
    }
  }
  if (column.best_before == column.best_after) return text;
  const auto name = [&check](const auto& law) { return law ? check.algorithms[*law] : std::string("none"); };
  return text + fmt::format("; best: {}, then {}", name(column.best_before), name(column.best_after));
}

}  // namespace

std::vector<std::string> compared_metrics() {
  std::vector<std::string> metrics;
  for (const RunHeading& heading : kRunHeadings)
    if (heading.factor != 0.0) metrics.emplace_back(heading.shows[0]);
  return metrics;
}

std::string ranking_text(const RankingCheck& check) {
  const auto is_other = [&check](const RankingColumn& c) { return c.scenario != check.columns.front().scenario; };
  const bool several = std::any_of(check.columns.begin(), check.columns.end(), is_other);
  std::vector<Table::Column> headings = {
      {"metric", false}, {"half the", false}, {"ranking", false}, {"numbers", false}};
  if (several) headings.insert(headings.begin(), {"scenario", false});
  Table table(headings);
  std::vector<std::string> changes;
  for (const RankingColumn& column : check.columns) {
    std::vector<std::string> cells = {
        column.metric.empty() ? "-" : column.metric, column.finer == Finer::spacing ? "spacing" : "step",
        holding_infos()[static_cast<std::size_t>(column.verdict.holding)].name, numbers_text(check, column)};
    if (several) cells.insert(cells.begin(), column.scenario);
    table.add(std::move(cells));
    if (column.metric.empty()) continue;
    const std::string change = several ? fmt::format("{}: {}", column.scenario, column.change) : column.change;
    if (changes.empty() || changes.back() != change) changes.push_back(change);
  }
  std::string text = "\ndoes the ranking hold?\n\n" + table.text(prose_width()) + "\n";
  for (const std::string& change : changes) text += wrapped(change, 0);
  return text +
         wrapped(
             fmt::format("holds: no two laws change their order, and no number moves by more than {0:g} %; drifts: a "
                         "number does; flips: two laws more than {0:g} % apart both times change their order, one "
                         "that fails being the worst. Differences below {1:g} % of a metric's largest do not count.",
                         100.0 * kHeld, 100.0 * kSameRank),
             0);
}

}  // namespace hapbench
