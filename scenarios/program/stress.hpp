#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/command_line.hpp"

/// The command `stress`.
namespace hapbench {

void add_stress(CommandLine& line);
/// For `describe`.
std::vector<DescribedTable> stress_tables();

}  // namespace hapbench
