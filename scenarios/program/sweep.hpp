#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/command_line.hpp"

/// The command `sweep`.
namespace hapbench {

void add_sweep(CommandLine& line);
/// Returns the tables that `sweep` writes and prints, for `describe`.
std::vector<DescribedTable> sweep_tables();

}  // namespace hapbench
