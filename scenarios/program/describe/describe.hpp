#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `describe`, which explains the names of the program and of the files installed beside it.
namespace hapbench {

void add_describe(CommandLine& line);

}  // namespace hapbench
