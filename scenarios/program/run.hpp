#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/command_line.hpp"

/// The command `run`.
namespace hapbench {

void add_run(CommandLine& line);
/// Returns the tables that `run` writes and prints, for `describe`.
std::vector<DescribedTable> single_run_tables();

}  // namespace hapbench
