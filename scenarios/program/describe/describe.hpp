#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `describe`, which explains the index and what lies in the folders beside the program.
namespace hapbench {

void add_describe(CommandLine& line);

}  // namespace hapbench
