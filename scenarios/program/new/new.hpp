#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `new`, which writes a scene to start from. Each scene runs at once, touches the surface, and has
/// only the fields that a beginner changes first.
namespace hapbench {

void add_new(CommandLine& line);

}  // namespace hapbench
