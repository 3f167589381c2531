#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `new`, which writes a scene to start from. Each scene can be run without further changes. In the run the
/// tool touches the surface. The scene has only the fields that a beginner changes first.
namespace hapbench {

void add_new(CommandLine& line);

}  // namespace hapbench
