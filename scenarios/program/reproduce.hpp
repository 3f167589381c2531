#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/command_line.hpp"

/// The command `reproduce`.
namespace hapbench {

void add_reproduce(CommandLine& line);
/// Returns the tables that `reproduce` writes and prints, for `describe`.
std::vector<DescribedTable> claim_tables();

}  // namespace hapbench
