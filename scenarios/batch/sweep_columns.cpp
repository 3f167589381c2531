#include "scenarios/batch/sweep_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "results/io/columns.hpp"
#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/input_error.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// Returns the row of a run without newline: its number, its varied fields, and `cells`.
std::string line_of(const SweepPlan& plan, std::size_t run, const std::vector<std::string>& cells) {
  std::string line = std::to_string(run);
  for (const std::string& value : plan.cases.values(run)) line += "," + csv_cell(value);
  for (const std::string& cell : cells) line += "," + cell;
  return line;
}

}  // namespace

std::vector<std::string> sweep_columns(const SweepPlan& plan) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : plan.cases.axes()) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps", std::string(kEndedAt)});
  columns.insert(columns.end(), plan.metrics.begin(), plan.metrics.end());
  for (const std::string& metric : plan.bounded) columns.push_back(std::string(kToleranceOf) + metric);
  columns.emplace_back("state_hash");
  return columns;
}

std::string error_row(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = {std::string(kErrorOutcome), "false"};
  cells.resize(sweep_columns(plan).size() - plan.cases.axes().size() - 1);
  return line_of(plan, run, cells);
}

std::string finished_row(const SweepPlan& plan, std::size_t run, const Result& summary) {
  std::vector<std::string> cells = {std::string(outcome_name(summary.end.outcome)), summary.expected ? "true" : "false",
                                    std::to_string(summary.end.rows), cell_text(cell_of(summary.end.ended_at))};
  const MetricList& metrics = summary.metrics;
  for (const Metric& metric : metrics) {
    if (std::ranges::find(plan.metrics, metric.name) != plan.metrics.end()) continue;
    throw InputError(fmt::format(
        "has the metric {}, which none of the first runs of the sweep records, so that the table has no column for it; "
        "allowed: sweeps whose first runs record all metrics of the other runs",
        metric.name));
  }
  for (const std::string& name : plan.metrics) cells.push_back(cell_text(value_of(metrics, name)));
  for (const std::string& name : plan.bounded) {
    const Metric* metric = find_metric(metrics, name);
    cells.push_back(metric == nullptr ? "" : cell_text(cell_of(metric->tolerance())));
  }
  cells.push_back(hash_text(summary.state_hash));
  return line_of(plan, run, cells);
}

}  // namespace hapbench
