#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `new`: each scene runs at once and touches something, and has only what a newcomer changes first.
namespace hapbench {

void add_new(CommandLine& line);

}  // namespace hapbench
