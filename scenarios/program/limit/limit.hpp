#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `limit`.
namespace hapbench {

void add_limit(CommandLine& line);

}  // namespace hapbench
