#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/command_line.hpp"

/// The command `converge`.
namespace hapbench {

void add_converge(CommandLine& line);
/// Returns the tables that `converge` writes and prints, for `describe`.
std::vector<DescribedTable> converge_tables();

}  // namespace hapbench
