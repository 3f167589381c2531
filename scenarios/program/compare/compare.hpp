#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `compare`.
namespace hapbench {

void add_compare(CommandLine& line);

}  // namespace hapbench
