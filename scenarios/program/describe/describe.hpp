#pragma once

#include "scenarios/program/command_line.hpp"

/// The command `describe`. It explains the names that a user meets: names defined in the program (algorithms, fields,
/// metrics, columns …), and the scenarios, studies, claims and glossary terms installed with the program.
namespace hapbench {

void add_describe(CommandLine& line);

}  // namespace hapbench
