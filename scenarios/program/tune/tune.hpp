#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `tune`.
namespace hapbench {

void add_tune(CommandLine& line);

}  // namespace hapbench
