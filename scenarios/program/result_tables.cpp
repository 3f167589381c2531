#include "scenarios/program/result_tables.hpp"

#include <algorithm>
#include <iterator>

#include "results/record/recorder.hpp"
#include "scenarios/program/compare/columns.hpp"
#include "scenarios/program/converge.hpp"
#include "scenarios/program/limit/columns.hpp"
#include "scenarios/program/replay.hpp"
#include "scenarios/program/reproduce.hpp"
#include "scenarios/program/run.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/stress.hpp"
#include "scenarios/program/sweep.hpp"
#include "scenarios/program/tune/columns.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {
namespace {

const std::vector<Column> kShellColumns = {{"x_m", "m", "x of the point of the shell"},
                                           {"y_m", "m", "y of the point of the shell"},
                                           {"z_m", "m", "z of the point of the shell"},
                                           {"nx", "1", "x of the outward unit normal at the point"},
                                           {"ny", "1", "y of the outward unit normal at the point"},
                                           {"nz", "1", "z of the outward unit normal at the point"}};

}  // namespace

std::vector<DescribedTable> result_tables() {
  std::vector<DescribedTable> tables;
  const auto add = [&tables](const ResultTable& table) {
    DescribedTable& added = tables.emplace_back(DescribedTable{table.file, table.holds});
    for (const auto& [name, unit, meaning] : table.columns) added.columns.push_back({name, unit, meaning});
  };
  for (const ResultTable& table : record_tables()) add(table);
  add(kTargetTable);
  for (auto* tables_of : {run_tables, single_run_tables, ranking_tables, limit_tables, converge_tables, tune_tables,
                          claim_tables, sweep_tables, stress_tables, replay_tables})
    std::ranges::move(tables_of(), std::back_inserter(tables));
  add({"shell.csv", "written by validate --points: one line per point of the environment", kShellColumns});
  return tables;
}

}  // namespace hapbench
