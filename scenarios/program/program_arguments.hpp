#pragma once

#include <string>
#include <vector>

namespace hapbench {

/// The arguments of a command line after the program's name.
using ProgramArguments = std::vector<std::string>;

/// Returns a command line for a POSIX shell. Arguments with characters other than letters, digits and
/// "_-./:=,+@%" are in single quotes.
std::string shell_line(const ProgramArguments& arguments);

}  // namespace hapbench
