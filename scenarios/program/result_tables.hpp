#pragma once

#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/program/report.hpp"

/// The tables of commands, for `describe`.
namespace hapbench {

// Of single commands, from the columns that these write and print.
std::vector<DescribedTable> claim_tables();
std::vector<DescribedTable> converge_tables();
DescribedTable stress_table();
DescribedTable sweep_table();
std::vector<DescribedTable> tune_tables();

/// Every table among the results of this program.
std::vector<DescribedTable> result_tables();

/// The headings of every printed table, also those that are names that `describe` knows.
std::vector<Table::Column> printed_headings();

}  // namespace hapbench
