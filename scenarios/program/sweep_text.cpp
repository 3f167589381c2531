#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/sweep.hpp"

namespace hapbench {
namespace {

std::string shown_value(const std::string& text) {
  const auto number = finite_number(text);
  return number ? significant(*number, 6) : text;
}

bool has_failed(const SweepTable& table, const SweepRow& row) {
  return table.outcome(row) == kErrorOutcome || is_failure(table.outcome(row));
}

/// What a cell of the file holds, by its looks.
Cell cell_of_text(const std::string& text) {
  if (text.empty()) return {};
  if (text == "true" || text == "false") return text == "true";
  if (const auto count = whole_number(text)) return std::uint64_t{*count};
  if (const auto number = finite_number(text)) return *number;
  return text;
}

constexpr Column kOwnColumns[] = {
    {"index", "1", "number of the run, from 0; the varied fields follow, by their paths"},
    {"outcome", "", "how the run ended; \"error\" for one that could not be computed"},
    {"expected", "", "true when it ended as the scenario's expect says"},
    {"steps", "1", "rows of the run"},
    {"state_hash", "", "over the bits of position, velocity and force of every row: equal for equal runs"}};

/// What there is to say of a column of the file; `metrics`: all there are.
Column described(const std::string& name, const MetricList& metrics) {
  for (const Column& own : kOwnColumns)
    if (name == own.name) return own;
  const bool is_tolerance = name.starts_with(kToleranceOf);
  const Metric* metric = find_metric(metrics, is_tolerance ? name.substr(kToleranceOf.size()) : name);
  if (metric == nullptr) return {name.c_str(), "by name", "value of the field"};
  return {name.c_str(), metric->unit, is_tolerance ? "by how much the metric may be wrong" : metric->meaning};
}

Columns<SweepRow> file_columns(const std::vector<std::string>& names) {
  const MetricList metrics = metrics_without_values();
  Columns<SweepRow> columns;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool is_hash = c + 1 == names.size();  // which may look like a number
    const Column column = described(names[c], metrics);
    columns.add(column.name, column.unit, column.meaning, [c, is_hash](const SweepRow& row) {
      return is_hash && !row[c].empty() ? Cell(row[c]) : cell_of_text(row[c]);
    });
  }
  return columns;
}

/// What is printed of a run, with the headings that run and compare have.
Columns<SweepRow> run_columns(const SweepTable& table) {
  Columns<SweepRow> columns;
  const bool single = table.axes.size() == 1;
  for (std::size_t c = single ? 1 : 0; c <= table.axes.size(); ++c) {
    std::string title = table.columns[c];
    if (const std::size_t dot = title.rfind('.'); !single && dot != std::string::npos) title.insert(dot + 1, "\n");
    const bool sampled = table.sampled && c > 0;
    columns.add(
        "", "by name", table.columns[c],
        [c, sampled](const SweepRow& row) -> Cell { return sampled ? shown_value(row[c]) : row[c]; },
        only_printed(title));
  }
  columns.add(
      "", "", "outcome", [&table](const SweepRow& row) -> Cell { return table.outcome(row); }, only_printed("outcome"));
  for (const RunHeading& heading : kRunHeadings) {
    if (std::ranges::find(table.columns, heading.metric) == table.columns.end()) continue;
    const auto cell = [&table, heading](const SweepRow& row) -> Cell {
      const auto value = table.number(row, heading.metric);
      if (!value) return "-";
      return significant(heading.factor * *value, deserved_digits(*value, table.tolerance(row, heading.metric), 3));
    };
    columns.add("", "by name", heading.metric, cell, only_printed(heading.title));
  }
  return columns;
}

using OutcomeCount = std::pair<const std::string, SweepCounts::Count>;

Columns<OutcomeCount> count_columns() {
  Columns<OutcomeCount> columns;
  columns.add(
      "", "", "outcome", [](const OutcomeCount& c) -> Cell { return c.first; }, only_printed("outcome"));
  columns.add(
      "", "1", "of sweep: number of the runs with this outcome",
      [](const OutcomeCount& c) -> Cell { return std::uint64_t{c.second.runs}; }, only_printed("runs"));
  columns.add(
      "", "1", "of sweep: number of these that ended as the scenario's expect says",
      [](const OutcomeCount& c) -> Cell { return std::uint64_t{c.second.expected}; }, only_printed("as expected"));
  return columns;
}

bool holds_texts(const Axis& axis) {
  return !std::ranges::all_of(axis.values, [](const auto& value) { return finite_number(value).has_value(); });
}

/// The metric over a grid of two fields, of which fields of texts go down; empty for other sweeps.
std::string grid_text(const SweepTable& table, const std::string& metric) {
  constexpr std::size_t kMostCells = 400;
  const std::vector<Axis>& axes = table.axes;
  if (axes.size() != 2 || table.sampled || axes[0].size() > kMostCells || axes[1].size() > kMostCells) return "";
  if (table.rows.size() != axes[0].size() * axes[1].size() || table.rows.size() > kMostCells) return "";
  const bool first_down = !holds_texts(axes[1]) || holds_texts(axes[0]);
  const Axis &down = axes[first_down ? 0 : 1], &across = axes[first_down ? 1 : 0];
  std::vector<Table::Column> columns = {{fmt::format("{} \\ {}", down.path, across.path), !holds_texts(down)}};
  for (std::size_t i = 0; i < across.size(); ++i) columns.push_back({shown_value(across.value(i))});
  Table shown(columns);
  for (std::size_t j = 0; j < down.size(); ++j) {
    std::vector<std::string> cells = {shown_value(down.value(j))};
    for (std::size_t i = 0; i < across.size(); ++i) {
      const SweepRow& row = table.rows[first_down ? j * across.size() + i : i * down.size() + j];
      const auto value = table.number(row, metric);
      const int digits = deserved_digits(value.value_or(0.0), table.tolerance(row, metric), 4);
      cells.push_back(has_failed(table, row) ? table.outcome(row) : significant(value, digits));
    }
    shown.add(std::move(cells));
  }
  return fmt::format("{}\n\n{}\n", metric, shown.text(prose_width()));
}

/// The rows with the least of the metric, failures last; for a single axis all rows.
std::string listed_text(const SweepTable& table, const std::string& metric) {
  constexpr std::size_t kMostShown = 100, kMostListed = 20;
  std::vector<SweepRow> rows = table.rows;
  const bool single = table.axes.size() == 1;
  if (rows.empty() || (single && rows.size() > kMostShown)) return "";
  const auto key = [&](const SweepRow& row) {
    const auto value = single ? finite_number(row[1]) : table.number(row, metric);
    return std::pair(has_failed(table, row), value.value_or(std::numeric_limits<double>::infinity()));
  };
  if (!single || table.sampled) std::ranges::stable_sort(rows, {}, key);
  if (single) return run_columns(table).table(rows).text() + "\n";
  rows.resize(std::min(kMostListed, rows.size()));
  return fmt::format("{} of {} runs, least {} first\n\n{}\n", rows.size(), table.rows.size(), metric,
                     run_columns(table).table(rows).text());
}

}  // namespace

std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for) {
  if (!asked_for.empty()) {
    require_valid_name("--metric: got", asked_for, metrics);
    return asked_for;
  }
  const auto has = [&](std::string_view name) { return std::ranges::find(metrics, name) != metrics.end(); };
  return std::string(*std::find_if(std::begin(kDefaultMetrics), std::end(kDefaultMetrics) - 1, has));
}

std::vector<DescribedTable> sweep_tables() {
  const MetricList metrics = metrics_without_values();
  std::vector<std::string> names = leading_columns({});
  for (const Metric& metric : metrics) names.push_back(metric.name);
  for (const Metric& metric : metrics)
    if (metric.bounded) names.push_back(std::string(kToleranceOf) + metric.name);
  names.emplace_back("state_hash");
  DescribedTable table = file_columns(names).described("sweep.csv", "of sweep: one line per run");
  table.headings = count_columns().headings();
  return {table};
}

std::string summary_text(const SweepTable& table, const std::string& metric) {
  std::string text = grid_text(table, metric);
  if (text.empty()) text = listed_text(table, metric);
  const std::vector<OutcomeCount> outcomes(table.kept.outcomes.begin(), table.kept.outcomes.end());
  return text + count_columns().table(outcomes).text();
}

Json summary_json(const SweepTable& table) {
  const SweepCounts& counts = table.kept;
  Json outcomes = Json::object();
  for (const auto& [outcome, count] : counts.outcomes) outcomes[outcome] = count.runs;
  Json json = {{"definition", table.definition},  {"runs", counts.runs},     {"outcomes", std::move(outcomes)},
               {"unexpected", counts.unexpected}, {"failed", counts.failed}, {"file", table.file.string()}};
  if (counts.runs > SweepTable::kMostRows) return json;
  const Columns<SweepRow> columns = file_columns(table.columns);
  Json& rows = json["rows"] = Json::array();
  for (const SweepRow& row : table.rows) {
    Json& added = rows.emplace_back(columns.json(row));
    for (std::size_t c = 1; c < table.outcome_place(); ++c)
      if (row[c].starts_with('{') || row[c].starts_with('[')) added[table.columns[c]] = parse_json(row[c]);
  }
  return json;
}

}  // namespace hapbench
