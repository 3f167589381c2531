#include "scenarios/program/result_tables.hpp"

#include <algorithm>
#include <iterator>

#include "results/record/recorder.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/league_text.hpp"
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

std::vector<DescribedTable> all_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const char* file, const char* holds, std::span<const Column> columns) {
    tables.push_back({file, holds, {columns.begin(), columns.end()}, {}});
  };
  for (const ResultTable& table : record_tables()) add(table.file, table.holds, all(table.columns));
  add(kTargetTable.file, kTargetTable.holds, all(kTargetTable.columns));
  for (auto* tables_of : {run_tables, league_tables, limit_tables, converge_tables, tune_tables, claim_tables})
    std::ranges::move(tables_of(), std::back_inserter(tables));
  tables.push_back(sweep_table());
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
  for (const DescribedTable& table : all_tables()) all.insert(all.end(), table.headings.begin(), table.headings.end());
  return all;
}

}  // namespace hapbench
