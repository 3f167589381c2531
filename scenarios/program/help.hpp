#pragma once

#include <string>

#include "scenarios/program/layout.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

/// The texts of --help.
namespace hapbench {

inline constexpr const char* kProgramSummary = "an offline bench for haptic rendering";

/// What the program prints without a command: the commands in their groups, and what to do first.
std::string front_text(const Layout& layout);
/// The answer of `hapbench --help`.
std::string program_help(const Layout& layout);
/// The help of a command, as wide as prose is.
std::string command_help(const CLI::App& command, const Layout& layout);

}  // namespace hapbench
