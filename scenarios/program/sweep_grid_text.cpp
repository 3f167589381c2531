#include "scenarios/program/sweep_grid_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "scenarios/batch/league.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/character_map.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostCells = 400;
/// From the least to the greatest value.
constexpr std::string_view kLevels = ".:-=+*%@";

struct Cell {
  std::optional<double> value;
  std::string failure;  ///< outcome of a run that failed
};

bool holds_texts(const Axis& axis) {
  return !std::all_of(axis.values.begin(), axis.values.end(),
                      [](const std::string& value) { return finite_number(value).has_value(); });
}

/// The field of a sweep that goes across, the one that goes down, and the cells.
class Grid {
 public:
  Grid(const SweepPlan& plan, const std::vector<SweepRow>& rows, std::string_view metric)
      : first_down_(!holds_texts(plan.points.axes()[1]) || holds_texts(plan.points.axes()[0])),
        across_(plan.points.axes()[first_down_ ? 1 : 0]),
        down_(plan.points.axes()[first_down_ ? 0 : 1]) {
    for (const SweepRow& row : rows) {
      const bool failed = row.outcome == kErrorOutcome || is_failure(row.outcome);
      cells_.push_back({failed ? std::nullopt : row.number(plan, metric), failed ? row.outcome : ""});
    }
  }

  const Axis& across() const { return across_; }
  const Axis& down() const { return down_; }
  /// Of the values of both fields by their places.
  const Cell& at(std::size_t i_across, std::size_t i_down) const {
    const std::size_t first = first_down_ ? i_down : i_across, second = first_down_ ? i_across : i_down;
    return cells_[first * (first_down_ ? across_ : down_).size() + second];
  }
  const std::vector<Cell>& cells() const { return cells_; }

 private:
  bool first_down_;
  const Axis& across_;
  const Axis& down_;
  std::vector<Cell> cells_;
};

std::string shown_value(const std::string& text) {
  const auto number = finite_number(text);
  return number ? significant(*number, 6) : text;
}

std::string cell_text(const Cell& cell) {
  if (!cell.failure.empty()) return cell.failure;
  return significant(cell.value.value_or(std::numeric_limits<double>::quiet_NaN()));
}

std::string table_text(const Grid& grid) {
  std::vector<Table::Column> columns = {
      {fmt::format("{} \\ {}", grid.down().path, grid.across().path), !holds_texts(grid.down())}};
  for (std::size_t i = 0; i < grid.across().size(); ++i) columns.push_back({shown_value(grid.across().value(i))});
  Table table(columns);
  for (std::size_t j = 0; j < grid.down().size(); ++j) {
    std::vector<std::string> cells = {shown_value(grid.down().value(j))};
    for (std::size_t i = 0; i < grid.across().size(); ++i) cells.push_back(cell_text(grid.at(i, j)));
    table.add(std::move(cells));
  }
  return table.text(prose_width());
}

/// Least and greatest value; none when there is none.
std::optional<std::pair<double, double>> range_of(const Grid& grid) {
  std::optional<std::pair<double, double>> range;
  for (const Cell& cell : grid.cells()) {
    if (!cell.value) continue;
    if (!range) range = {*cell.value, *cell.value};
    range->first = std::min(range->first, *cell.value);
    range->second = std::max(range->second, *cell.value);
  }
  return range;
}

/// Levels in equal ratios where values are more than a decade apart.
bool is_logarithmic(std::pair<double, double> range) {
  return range.first > 0.0 && range.second > 10.0 * range.first;
}

char level(double value, std::pair<double, double> range) {
  auto [least, greatest] = range;
  if (!(greatest > least)) return kLevels.front();
  if (is_logarithmic(range)) {
    value = std::log(value);
    least = std::log(least);
    greatest = std::log(greatest);
  }
  const double part = (value - least) / (greatest - least) * static_cast<double>(kLevels.size());
  return kLevels[std::min(static_cast<std::size_t>(std::max(part, 0.0)), kLevels.size() - 1)];
}

std::string map_text(const Grid& grid, std::string_view metric) {
  const auto range = range_of(grid);
  if (!range) return "";
  const auto cell = [&](std::size_t i, std::size_t j) {
    const Cell& c = grid.at(i, j);
    return !c.failure.empty() ? '#' : c.value ? level(*c.value, *range) : '?';
  };
  std::vector<std::string> labels;
  for (std::size_t j = 0; j < grid.down().size(); ++j) labels.push_back(shown_value(grid.down().value(j)));
  const Axis& across = grid.across();
  return fmt::format("{}  {}: {} {} ... {} {}{}; # failed, ? no value\n",
                     character_map({across.path, across.size(), shown_value(across.value(0)),
                                    shown_value(across.value(across.size() - 1))},
                                   grid.down().path, labels, cell),
                     metric, kLevels.front(), significant(range->first, 3), kLevels.back(),
                     significant(range->second, 3), is_logarithmic(*range) ? ", in equal ratios" : "");
}

}  // namespace

std::string grid_text(const SweepPlan& plan, const std::vector<SweepRow>& rows, std::string_view metric) {
  const bool is_grid = plan.points.axes().size() == 2 && !plan.points.sampling();
  if (!is_grid || rows.size() != plan.points.size() || rows.size() > kMostCells) return "";
  const Grid grid(plan, rows, metric);
  std::string text = fmt::format("{}\n\n{}\n", metric, table_text(grid));
  constexpr std::size_t kMostAcross = 40;  // two characters each, beside the labels
  if (grid.across().size() <= kMostAcross) text += map_text(grid, metric) + "\n";
  return text;
}

}  // namespace hapbench
