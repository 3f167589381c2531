#pragma once

#include <string>

#include "scenarios/program/layout.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

/// The texts of --help.
namespace hapbench {

inline constexpr const char* kProgramSummary = "an offline bench for haptic rendering";

/// Returns the text that the program prints without a command: the commands in their groups, and the first
/// commands to try.
std::string front_text(const Layout& layout);
/// Returns the text of `hapbench --help`. `program`: has the commands as subcommands.
std::string program_help(const CLI::App& program, const Layout& layout);
/// Returns the help of a command, wrapped to Layout::prose_width().
std::string command_help(const CLI::App& command, const Layout& layout);

}  // namespace hapbench
