#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/command_line.hpp"

/// The command `stress`.
namespace hapbench {

void add_stress(CommandLine& line);
/// Returns the tables that `stress` writes and prints, for `describe`.
std::vector<DescribedTable> stress_tables();

}  // namespace hapbench
