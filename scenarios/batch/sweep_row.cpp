#include "scenarios/batch/sweep_row.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// What every row begins with: run and varied fields.
std::string leading_cells(const SweepPlan& plan, std::size_t run) {
  return fmt::format("{},{}", run, fmt::join(plan.points.values(run), ","));
}

void append_cell(std::string& row, std::string_view cell) {
  row += ',';
  row += cell;
}

}  // namespace

std::string sweep_header(const SweepPlan& plan) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : plan.points.axes()) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  columns.insert(columns.end(), plan.metrics.begin(), plan.metrics.end());
  columns.emplace_back("state_hash");
  return fmt::format("{}", fmt::join(columns, ","));
}

std::string sweep_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary) {
  std::string row = leading_cells(plan, run);
  append_cell(row, outcome_name(summary.result.outcome));
  append_cell(row, summary.expected ? "true" : "false");
  append_cell(row, std::to_string(summary.result.rows));
  const MetricList metrics = metric_list(summary);
  auto next = metrics.begin();  // the columns are in the same order, but some runs have more metrics than others
  for (const std::string& name : plan.metrics) {
    const bool is_it = next != metrics.end() && next->name == name;
    append_cell(row, is_it ? cell_text(next->value) : "");
    if (is_it) ++next;
  }
  if (next != metrics.end()) {
    throw InputError(
        fmt::format("has the metric {}, for which no run that was checked before the first one has a column; allowed: "
                    "sweeps whose first runs record what the others record",
                    next->name));
  }
  append_cell(row, hash_text(summary.metrics.state_hash));
  return row;
}

std::string error_row(const SweepPlan& plan, std::size_t run) {
  const std::size_t empty = 1 + plan.metrics.size() + 1;  // steps, metrics, state_hash
  return fmt::format("{},{},false{}", leading_cells(plan, run), kErrorOutcome, std::string(empty, ','));
}

std::optional<std::size_t> run_of_row(const SweepPlan& plan, std::string_view row) {
  const auto run = whole_number(row.substr(0, row.find(',')));
  const std::size_t columns = 1 + plan.points.axes().size() + 3 + plan.metrics.size() + 1;  // as sweep_header has them
  const auto commas = static_cast<std::size_t>(std::count(row.begin(), row.end(), ','));
  if (!run || *run >= plan.points.size() || commas + 1 != columns) return std::nullopt;
  return row.starts_with(leading_cells(plan, *run) + ",") ? run : std::nullopt;
}

}  // namespace hapbench
