#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "scenarios/batch/league.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/sweep.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostRowsShown = 100;
constexpr std::size_t kMostCells = 400;

bool has_metric(const SweepPlan& plan, std::string_view name) {
  return std::find(plan.metrics.begin(), plan.metrics.end(), name) != plan.metrics.end();
}

std::string shown_value(const std::string& text) {
  const auto number = finite_number(text);
  return number ? significant(*number, 6) : text;
}

bool has_failed(const SweepRow& row) {
  return row.outcome == kErrorOutcome || is_failure(row.outcome);
}

/// The runs with the headings that run and compare have.
std::string runs_text(const SweepPlan& plan, std::span<const SweepRow> rows) {
  const std::vector<Axis>& axes = plan.cases.axes();
  std::vector<RunHeading> metrics;
  std::vector<Table::Column> columns;
  if (axes.size() == 1) {
    columns = {{axes[0].path}};
  } else {
    columns = {{"index"}};
    for (const Axis& axis : axes) {
      std::string title = axis.path;
      if (const std::size_t dot = title.rfind('.'); dot != std::string::npos) title.insert(dot + 1, "\n");
      columns.push_back({title});
    }
  }
  columns.push_back({"outcome", false});
  for (const RunHeading& heading : kRunHeadings) {
    if (!has_metric(plan, heading.metric)) continue;
    metrics.push_back(heading);
    columns.push_back({heading.title});
  }
  Table table(columns);
  for (const SweepRow& row : rows) {
    std::vector<std::string> cells;
    if (axes.size() > 1) cells.push_back(std::to_string(row.run));
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const std::string& value = row.values[a];
      cells.push_back(plan.cases.sampling() ? shown_value(value) : value);
    }
    cells.push_back(row.outcome);
    for (const RunHeading& heading : metrics) {
      const double value = row.number(plan, heading.metric).value_or(std::numeric_limits<double>::quiet_NaN());
      const int digits = deserved_digits(value, row.tolerance(plan, heading.metric), 3);
      cells.push_back(significant(heading.factor * value, digits));
    }
    table.add(std::move(cells));
  }
  return table.text();
}

bool holds_texts(const Axis& axis) {
  return !std::all_of(axis.values.begin(), axis.values.end(),
                      [](const std::string& value) { return finite_number(value).has_value(); });
}

struct GridCell {
  std::optional<double> value;
  std::optional<double> tolerance;
  std::string failure;  ///< outcome of a run that failed
};

/// A sweep of two fields by one metric. One field goes across, the other one down; fields of texts go down.
class Grid {
 public:
  Grid(const SweepPlan& plan, const std::vector<SweepRow>& rows, std::string_view metric)
      : first_down_(!holds_texts(plan.cases.axes()[1]) || holds_texts(plan.cases.axes()[0])),
        across_(plan.cases.axes()[first_down_ ? 1 : 0]),
        down_(plan.cases.axes()[first_down_ ? 0 : 1]) {
    for (const SweepRow& row : rows) {
      const bool failed = has_failed(row);
      cells_.push_back(
          {failed ? std::nullopt : row.number(plan, metric), row.tolerance(plan, metric), failed ? row.outcome : ""});
    }
  }

  const Axis& across() const { return across_; }
  const Axis& down() const { return down_; }
  const GridCell& at(std::size_t i_across, std::size_t i_down) const {
    const std::size_t first = first_down_ ? i_down : i_across, second = first_down_ ? i_across : i_down;
    return cells_[first * (first_down_ ? across_ : down_).size() + second];
  }
  const std::vector<GridCell>& cells() const { return cells_; }

 private:
  bool first_down_;
  const Axis& across_;
  const Axis& down_;
  std::vector<GridCell> cells_;
};

std::string table_text(const Grid& grid) {
  std::vector<Table::Column> columns = {
      {fmt::format("{} \\ {}", grid.down().path, grid.across().path), !holds_texts(grid.down())}};
  for (std::size_t i = 0; i < grid.across().size(); ++i) columns.push_back({shown_value(grid.across().value(i))});
  Table table(columns);
  for (std::size_t j = 0; j < grid.down().size(); ++j) {
    std::vector<std::string> cells = {shown_value(grid.down().value(j))};
    for (std::size_t i = 0; i < grid.across().size(); ++i) {
      const GridCell& cell = grid.at(i, j);
      const int digits = deserved_digits(cell.value.value_or(0.0), cell.tolerance, 4);
      cells.push_back(!cell.failure.empty() ? cell.failure : significant(cell.value, digits));
    }
    table.add(std::move(cells));
  }
  return table.text(prose_width());
}

/// The levels of a map between the least and the greatest value, in equal ratios where they are more than a decade
/// apart.
class Levels {
 public:
  static constexpr std::string_view kMarks = ".:-=+*%@";

  explicit Levels(const std::vector<GridCell>& cells) {
    for (const GridCell& cell : cells) {
      if (!cell.value) continue;
      least_ = std::min(least_, *cell.value);
      greatest_ = std::max(greatest_, *cell.value);
    }
  }

  bool empty() const { return least_ > greatest_; }
  char mark(double value) const {
    if (!(greatest_ > least_)) return kMarks.front();
    const auto scaled = [this](double x) { return is_logarithmic() ? math::log(x) : x; };
    const double part =
        (scaled(value) - scaled(least_)) / (scaled(greatest_) - scaled(least_)) * static_cast<double>(kMarks.size());
    return kMarks[std::min(static_cast<std::size_t>(std::max(part, 0.0)), kMarks.size() - 1)];
  }
  std::string legend() const {
    return fmt::format("{} {} ... {} {}{}", kMarks.front(), significant(least_, 3), kMarks.back(),
                       significant(greatest_, 3), is_logarithmic() ? ", in equal ratios" : "");
  }

 private:
  bool is_logarithmic() const { return least_ > 0.0 && greatest_ > 10.0 * least_; }

  double least_ = std::numeric_limits<double>::infinity();
  double greatest_ = -std::numeric_limits<double>::infinity();
};

/// Of each outcome that is a failure its first letter that no other has, in capitals.
std::map<std::string, char> failure_letters(const std::vector<GridCell>& cells) {
  std::map<std::string, char> letters;
  for (const GridCell& cell : cells)
    if (!cell.failure.empty()) letters[cell.failure] = '#';
  std::string used = "_";
  for (auto& [outcome, letter] : letters) {
    const std::size_t free = outcome.find_first_not_of(used);
    if (free == std::string::npos) continue;
    used += outcome[free];
    letter = static_cast<char>(std::toupper(outcome[free]));
  }
  return letters;
}

std::string map_text(const Grid& grid, std::string_view metric) {
  const Levels levels(grid.cells());
  if (levels.empty()) return "";
  const std::map<std::string, char> letters = failure_letters(grid.cells());
  const auto mark = [&](std::size_t i, std::size_t j) {
    const GridCell& cell = grid.at(i, j);
    return !cell.failure.empty() ? letters.at(cell.failure) : cell.value ? levels.mark(*cell.value) : '?';
  };
  std::vector<std::string> labels;
  for (std::size_t j = 0; j < grid.down().size(); ++j) labels.push_back(shown_value(grid.down().value(j)));
  const Axis& across = grid.across();
  const MapColumns columns{across.path, across.size(), shown_value(across.value(0)),
                           shown_value(across.value(across.size() - 1))};
  std::string failures;
  for (const auto& [outcome, letter] : letters) failures += fmt::format("{} {}, ", letter, outcome);
  return fmt::format("{}  {}: {}; {}? no value\n", character_map(columns, grid.down().path, labels, mark), metric,
                     levels.legend(), failures);
}

std::string grid_text(const SweepPlan& plan, const std::vector<SweepRow>& rows, std::string_view metric) {
  const bool is_grid = plan.cases.axes().size() == 2 && !plan.cases.sampling();
  if (!is_grid || rows.size() != plan.cases.size() || rows.size() > kMostCells) return "";
  const Grid grid(plan, rows, metric);
  std::string text = fmt::format("{}\n\n{}\n", metric, table_text(grid));
  constexpr std::size_t kMostAcross = 40;  // a wider map does not fit beside its labels
  if (grid.across().size() <= kMostAcross) text += map_text(grid, metric) + "\n";
  return text;
}

/// The rows with the least of the metric, failures last; for a single axis all rows.
std::string listed_text(const SweepPlan& plan, std::vector<SweepRow> rows, const std::string& metric) {
  constexpr std::size_t kMostListed = 20;
  const bool single = plan.cases.axes().size() == 1;
  if (rows.empty() || (single && rows.size() > kMostRowsShown)) return "";
  const auto key = [&](const SweepRow& row) {
    const auto value = single ? finite_number(row.values[0]) : row.number(plan, metric);
    return value.value_or(std::numeric_limits<double>::infinity());
  };
  if (!single || plan.cases.sampling())
    std::ranges::stable_sort(rows, {}, [&](const SweepRow& row) { return std::pair(has_failed(row), key(row)); });
  if (single) return runs_text(plan, rows) + "\n";
  const std::size_t shown = std::min(kMostListed, rows.size());
  return fmt::format("{} of {} runs, least {} first\n\n{}\n", shown, rows.size(), metric,
                     runs_text(plan, std::span(rows).first(shown)));
}

}  // namespace

std::string chosen_metric(const SweepPlan& plan, const std::string& asked_for) {
  if (!asked_for.empty()) {
    require_valid_name("--metric: got", asked_for, plan.metrics);
    return asked_for;
  }
  const auto has = [&plan](std::string_view name) { return has_metric(plan, name); };
  return std::string(*std::find_if(std::begin(kDefaultMetrics), std::end(kDefaultMetrics) - 1, has));
}

std::vector<Table::Column> sweep_headings() {
  return {{"outcome", false},
          {"runs", true, "of sweep: number of the runs with this outcome"},
          {"as expected", true, "number of these that ended as the scenario's expect says"}};
}

std::string summary_text(const SweepPlan& plan, const SweepReport& report, const std::string& metric) {
  std::string text = grid_text(plan, report.rows, metric);
  if (text.empty()) text = listed_text(plan, report.rows, metric);
  Table table(sweep_headings());
  for (const auto& [outcome, count] : report.counts.outcomes) {
    table.add({outcome, std::to_string(count.runs), std::to_string(count.expected)});
  }
  text += table.text();
  if (report.resumed > 0) text += fmt::format("\n{} of the runs were done before\n", report.resumed);
  return text + fmt::format("\nresults in {}\n", report.table.string());
}

Json summary_json(const SweepPlan& plan, const SweepReport& report) {
  const SweepCounts& counts = report.counts;
  Json outcomes = Json::object();
  for (const auto& [outcome, count] : counts.outcomes) outcomes[outcome] = count.runs;
  Json json = {{"definition", plan.definition},   {"runs", counts.runs},     {"outcomes", std::move(outcomes)},
               {"unexpected", counts.unexpected}, {"failed", counts.failed}, {"file", report.table.string()}};
  if (counts.runs > SweepReport::kMostRows) return json;
  Json& rows = json["rows"] = Json::array();
  for (const SweepRow& row : report.rows) rows.push_back(row_json(plan, row));
  return json;
}

}  // namespace hapbench
