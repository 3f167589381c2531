#pragma once

#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/program/report.hpp"

/// The tables of commands, for `describe`.
namespace hapbench {

// Of single commands, from the columns that these write and print.
std::vector<Column> stability_limit_columns();
std::vector<Column> root_locus_columns();
std::vector<DescribedTable> claim_tables();
std::vector<DescribedTable> converge_tables();
std::vector<DescribedTable> diff_tables();
DescribedTable stress_table();
std::vector<Column> tune_columns();
std::vector<Column> tune_trial_columns();

std::vector<Table::Column> stability_headings();
std::vector<Table::Column> sweep_headings();
std::vector<Table::Column> tune_headings();

/// Every table among the results of this program.
std::vector<DescribedTable> result_tables();

/// The headings of every printed table, also those that are names that `describe` knows.
std::vector<Table::Column> printed_headings();

}  // namespace hapbench
