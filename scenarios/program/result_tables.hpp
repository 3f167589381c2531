#pragma once

#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/program/report.hpp"

/// The columns of the tables that commands write beside the files of single runs. Those who write them take their
/// headers from here.
namespace hapbench {

// The columns of tables that are defined as fields in the sources of their commands.
std::vector<Column> converge_columns();
std::vector<Column> converge_level_columns();
DescribedTable stress_table();
DescribedTable sweep_table();
std::vector<DescribedTable> tune_tables();

// The headings of printed tables, from which the tables are made; without those that are names of fields, metrics,
// scenes or algorithms.
std::vector<Table::Column> claim_headings();
std::vector<Table::Column> converge_headings();
std::vector<Table::Column> league_headings();
std::vector<Table::Column> run_headings();
std::vector<Table::Column> latency_headings();

std::vector<Table::Column> joined_headings(const std::vector<std::vector<Table::Column>>& tables);
/// All of them, also those whose titles are names that `describe` knows.
std::vector<Table::Column> printed_headings();

/// Every table among the results of this program.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
