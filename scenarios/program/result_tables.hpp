#pragma once

#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/program/report.hpp"

/// The columns of the tables that commands write beside the files of single runs. Those who write them take their
/// headers from here.
namespace hapbench {

// The columns of tables that are defined as fields in the sources of their commands.
std::vector<Column> stability_limit_columns();
std::vector<Column> root_locus_columns();
std::vector<DescribedTable> converge_tables();
DescribedTable stress_table();
std::vector<Column> tune_columns();
std::vector<Column> tune_trial_columns();

// The headings of printed tables, from which the tables are made; without those that are names of fields, metrics,
// scenes or algorithms.
std::vector<Table::Column> claim_headings();
std::vector<Table::Column> diff_headings();
std::vector<Table::Column> stability_headings();
std::vector<Table::Column> sweep_headings();
std::vector<Table::Column> tune_headings();

std::vector<Table::Column> joined_headings(const std::vector<std::vector<Table::Column>>& tables);
/// All of them, also those whose titles are names that `describe` knows.
std::vector<Table::Column> printed_headings();

/// Every table among the results of this program.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
