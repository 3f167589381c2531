#include "scenarios/program/result_tables.hpp"

#include <algorithm>
#include <iterator>

#include "results/record/recorder.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/league_text.hpp"
#include "scenarios/program/limit_answers.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {
namespace {

constexpr Column kShellColumns[] = {
    {"x_m", "m", "x of a point of the shell"},         {"y_m", "m", "y of a point of the shell"},
    {"z_m", "m", "z of a point of the shell"},         {"nx", "1", "x of the outward unit normal there"},
    {"ny", "1", "y of the outward unit normal there"}, {"nz", "1", "z of the outward unit normal there"}};

/// A sweep's table has the metrics that `expect` may bound between `steps` and `state_hash`.
std::vector<Column> sweep_columns() {
  static const MetricList kShownMetrics = metrics_without_values();
  std::vector<Column> columns = {{"index", "1", "number of the run, from 0; the varied fields follow, by their paths"},
                                 {"outcome", "", "how the run ended; \"error\" for one that could not be computed"},
                                 {"expected", "", "true when it ended as the scenario's expect says"},
                                 {"steps", "1", "rows of the run"}};
  for (const Metric& metric : kShownMetrics) columns.push_back({metric.name.c_str(), metric.unit, metric.meaning});
  static const std::vector<std::string> kTolerances = [] {
    std::vector<std::string> names;
    for (const Metric& metric : kShownMetrics) names.push_back(std::string(kToleranceOf) + metric.name);
    return names;
  }();
  for (std::size_t i = 0; i < kShownMetrics.size(); ++i) {
    if (kShownMetrics[i].bounded)
      columns.push_back({kTolerances[i].c_str(), kShownMetrics[i].unit, "by how much the metric may be wrong"});
  }
  columns.push_back(
      {"state_hash", "", "over the bits of position, velocity and force of every row: equal for equal runs"});
  return columns;
}

std::vector<Column> all(std::span<const Column> columns) {
  return {columns.begin(), columns.end()};
}

std::vector<DescribedTable> all_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const char* file, const char* holds, std::span<const Column> columns) {
    tables.push_back({file, holds, {columns.begin(), columns.end()}, {}});
  };
  for (const ResultTable& table : record_tables()) add(table.file, table.holds, all(table.columns));
  add(kTargetTable.file, kTargetTable.holds, all(kTargetTable.columns));
  for (auto* tables_of : {run_tables, league_tables, limit_tables, converge_tables, diff_tables, claim_tables})
    std::ranges::move(tables_of(), std::back_inserter(tables));
  add("tune.csv", "of tune: one line per algorithm", tune_columns());
  add("tune_trials.csv", "of tune: one line per algorithm, setting and K that was tried", tune_trial_columns());
  add("sweep.csv", "of sweep: one line per run", sweep_columns());
  add("limits.csv", "of stability SCENARIO: one line per limit", stability_limit_columns());
  add("root_locus.csv", "of stability SCENARIO: eigenvalues of a step as the case's number grows",
      root_locus_columns());
  tables.push_back(stress_table());
  add("shell.csv", "of shell: one line per point of the environment", all(kShellColumns));
  return tables;
}

}  // namespace

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables = all_tables();
  std::erase_if(tables, [](const DescribedTable& table) { return table.file.empty(); });
  return tables;
}

std::vector<Table::Column> printed_headings() {
  std::vector<Table::Column> all;
  for (const auto& headings : {stability_headings(), sweep_headings(), tune_headings()})
    all.insert(all.end(), headings.begin(), headings.end());
  for (const DescribedTable& table : all_tables()) all.insert(all.end(), table.headings.begin(), table.headings.end());
  return all;
}

}  // namespace hapbench
