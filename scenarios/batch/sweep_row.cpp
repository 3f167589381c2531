#include "scenarios/batch/sweep_row.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "results/summary/outcome_names.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// The cells every row begins with.
std::vector<std::string> leading_cells(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = plan.points.values(run);
  cells.insert(cells.begin(), std::to_string(run));
  return cells;
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
  std::vector<std::string> cells = leading_cells(plan, run);
  cells.emplace_back(outcome_name(summary.result.outcome));
  cells.emplace_back(summary.expected ? "true" : "false");
  cells.push_back(std::to_string(summary.result.rows));
  const MetricList metrics = metric_list(summary);
  for (const std::string& name : plan.metrics) cells.push_back(cell_text(value_of(metrics, name)));
  cells.push_back(hash_text(summary.metrics.state_hash));
  return fmt::format("{}", fmt::join(cells, ","));
}

std::string error_row(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = leading_cells(plan, run);
  cells.emplace_back(kErrorOutcome);
  cells.emplace_back("false");
  cells.resize(cells.size() + 1 + plan.metrics.size() + 1);  // steps, metrics, state_hash
  return fmt::format("{}", fmt::join(cells, ","));
}

std::optional<std::size_t> run_of_row(const SweepPlan& plan, std::string_view row) {
  const Words cells = parts_of(row, ',');
  const auto run = whole_number(cells[0]);
  const std::size_t columns = parts_of(sweep_header(plan), ',').size();
  if (!run || *run >= plan.points.size() || cells.size() != columns) return std::nullopt;
  const std::vector<std::string> leading = leading_cells(plan, *run);
  return std::equal(leading.begin(), leading.end(), cells.begin()) ? run : std::nullopt;
}

}  // namespace hapbench
