#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// The cells in front of the metrics: run, varied fields, outcome, expected, steps.
std::size_t leading_columns(const SweepPlan& plan) {
  return 1 + plan.cases.axes().size() + 3;
}

/// The number in a cell: a count if it is a whole number, so that it is printed as it is in the table.
Metric::Value value_in(std::string_view cell) {
  if (const auto count = whole_number(cell)) return static_cast<std::uint64_t>(*count);
  if (const auto number = finite_number(cell)) return *number;
  return {};
}

Json json_of(const Metric::Value& value) {
  return std::visit(
      [](const auto& number) {
        if constexpr (std::is_same_v<std::decay_t<decltype(number)>, std::monostate>)
          return Json(nullptr);
        else
          return Json(number);
      },
      value);
}

/// The value of a varied field, whose type is not known.
Json json_of_text(const std::string& text) {
  if (text.starts_with('{') || text.starts_with('[')) return parse_json(text);
  if (text == "true" || text == "false") return text == "true";
  const Metric::Value value = value_in(text);
  return std::holds_alternative<std::monostate>(value) ? Json(text) : json_of(value);
}

}  // namespace

std::optional<double> SweepRow::number(const SweepPlan& plan, std::string_view metric) const {
  const auto column = std::find(plan.metrics.begin(), plan.metrics.end(), metric) - plan.metrics.begin();
  return number_of(metrics[static_cast<std::size_t>(column)]);
}

std::optional<double> SweepRow::tolerance(const SweepPlan& plan, std::string_view metric) const {
  const auto name = std::find(plan.bounded.begin(), plan.bounded.end(), metric);
  if (name == plan.bounded.end()) return std::nullopt;
  return number_of(tolerances[static_cast<std::size_t>(name - plan.bounded.begin())]);
}

SweepRow sweep_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary) {
  SweepRow row{.run = run,
               .values = plan.cases.values(run),
               .outcome = std::string(outcome_name(summary.result.outcome)),
               .expected = summary.expected,
               .steps = static_cast<std::size_t>(summary.result.rows),
               .metrics = {},
               .tolerances = {},
               .state_hash = hash_text(summary.metrics.state_hash)};
  const MetricList metrics = metric_list(summary);
  auto next = metrics.begin();  // the columns are in the same order, but some runs have more metrics than others
  for (const std::string& name : plan.metrics) {
    const bool is_it = next != metrics.end() && next->name == name;
    row.metrics.push_back(is_it ? next->value : Metric::Value());
    if (is_it) ++next;
  }
  if (next != metrics.end()) {
    throw InputError(
        fmt::format("has the metric {}, for which no run that was checked before the first one has a column; allowed: "
                    "sweeps whose first runs record what the others record",
                    next->name));
  }
  for (const std::string& name : plan.bounded) {
    const Metric* metric = find_metric(metrics, name);
    const auto tolerance = metric != nullptr ? metric->tolerance() : std::nullopt;
    row.tolerances.push_back(tolerance ? Metric::Value(*tolerance) : Metric::Value());
  }
  return row;
}

SweepRow error_row(const SweepPlan& plan, std::size_t run) {
  return {.run = run,
          .values = plan.cases.values(run),
          .outcome = std::string(kErrorOutcome),
          .expected = false,
          .steps = std::nullopt,
          .metrics = std::vector<Metric::Value>(plan.metrics.size()),
          .tolerances = std::vector<Metric::Value>(plan.bounded.size()),
          .state_hash = ""};
}

std::string sweep_header(const SweepPlan& plan) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : plan.cases.axes()) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  columns.insert(columns.end(), plan.metrics.begin(), plan.metrics.end());
  for (const std::string& metric : plan.bounded) columns.push_back(std::string(kToleranceOf) + metric);
  columns.emplace_back("state_hash");
  return fmt::format("{}", fmt::join(columns, ","));
}

std::string row_text(const SweepRow& row) {
  std::string text = std::to_string(row.run);
  for (const std::string& value : row.values) text += "," + csv_cell(value);
  text += fmt::format(",{},{},{}", row.outcome, row.expected, row.steps ? std::to_string(*row.steps) : "");
  for (const auto* values : {&row.metrics, &row.tolerances})
    for (const Metric::Value& value : *values) text += "," + cell_text(value);
  return text + "," + row.state_hash;
}

std::optional<SweepRow> parse_row(const SweepPlan& plan, std::string_view text) {
  std::vector<std::string> cells = csv_cells(text);
  const std::size_t axes = plan.cases.axes().size(), first_metric = leading_columns(plan);
  const auto run = whole_number(cells[0]);
  if (!run || *run >= plan.cases.size() || cells.size() != first_metric + plan.metrics.size() + plan.bounded.size() + 1)
    return std::nullopt;
  SweepRow row{.run = *run,
               .values = {cells.begin() + 1, cells.begin() + 1 + static_cast<std::ptrdiff_t>(axes)},
               .outcome = cells[1 + axes],
               .expected = cells[2 + axes] == "true",
               .steps = whole_number(cells[3 + axes]),
               .metrics = {},
               .tolerances = {},
               .state_hash = cells.back()};
  row.metrics.reserve(plan.metrics.size());
  for (std::size_t m = first_metric; m + 1 < cells.size(); ++m)
    (row.metrics.size() < plan.metrics.size() ? row.metrics : row.tolerances).push_back(value_in(cells[m]));
  return row;
}

Json row_json(const SweepPlan& plan, const SweepRow& row) {
  const std::vector<std::string> names = csv_cells(sweep_header(plan)), cells = csv_cells(row_text(row));
  const std::size_t steps = leading_columns(plan) - 1, hash = cells.size() - 1;
  Json json;
  for (std::size_t c = 0; c < cells.size(); ++c)
    json[names[c]] = c < steps ? json_of_text(cells[c]) : json_of(value_in(cells[c]));
  json[names[hash]] = cells[hash].empty() ? Json(nullptr) : Json(cells[hash]);
  return json;
}

void SweepCounts::add(const SweepRow& row) {
  const bool is_failure = row.outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[row.outcome];
  ++count.runs;
  if (row.expected) ++count.expected;
  if (is_failure) ++failed;
  if (is_failure || row.expected) return;
  ++unexpected;
  if (!first_unexpected) first_unexpected = row.run;
}

Json sweep_description(const SweepPlan& plan, const Shard& shard) {
  Json description = {{"definition", plan.definition}, {"runs", plan.cases.size()}, {"shard", shard_text(shard)}};
  description.update(plan.content);
  return description;
}

}  // namespace hapbench
