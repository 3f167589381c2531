#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `validate`.
namespace hapbench {

void add_validate(CommandLine& line);

}  // namespace hapbench
