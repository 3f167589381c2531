#include "scenarios/program/result_tables.hpp"

#include <fmt/format.h>

#include "results/record/recorder.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/limit_cases.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {
namespace {

constexpr Column kShellColumns[] = {
    {"x_m", "m", "x of a point of the shell"},         {"y_m", "m", "y of a point of the shell"},
    {"z_m", "m", "z of a point of the shell"},         {"nx", "1", "x of the outward unit normal there"},
    {"ny", "1", "y of the outward unit normal there"}, {"nz", "1", "z of the outward unit normal there"}};

std::vector<Column> all(std::span<const Column> columns) {
  return {columns.begin(), columns.end()};
}

}  // namespace

std::vector<Table::Column> joined_headings(const std::vector<std::vector<Table::Column>>& tables) {
  std::vector<Table::Column> all;
  for (const std::vector<Table::Column>& table : tables) all.insert(all.end(), table.begin(), table.end());
  return all;
}

std::vector<Table::Column> printed_headings() {
  std::vector<std::vector<Table::Column>> all = {run_headings(), league_headings(), converge_headings(),
                                                 claim_headings()};
  for (const DescribedTable& table : result_tables()) all.push_back(table.headings);
  return joined_headings(all);
}

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const char* file, const char* holds, std::span<const Column> columns) {
    tables.push_back({file, holds, {columns.begin(), columns.end()}, {}});
  };
  for (const ResultTable& table : record_tables()) add(table.file, table.holds, all(table.columns));
  add(kTargetTable.file, kTargetTable.holds, all(kTargetTable.columns));
  add("comparison.csv", "of compare: one line per algorithm", comparison_columns());
  add("league.csv", "of compare with several scenarios or seeds: one line per scenario, algorithm and metric",
      league_columns());
  for (const DescribedTable& table : limit_tables()) tables.push_back(table);
  add("converge.csv", "of converge: one line per metric", converge_columns());
  add("converge_levels.csv", "of converge: one line per metric and level", converge_level_columns());
  for (const DescribedTable& table : tune_tables()) tables.push_back(table);
  tables.push_back(sweep_table());
  tables.push_back(stress_table());
  add("shell.csv", "of shell: one line per point of the environment", all(kShellColumns));
  return tables;
}

}  // namespace hapbench
