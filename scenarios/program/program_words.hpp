#pragma once

#include <string>
#include <vector>

namespace hapbench {

/// The words of a command line behind the program's name.
using ProgramWords = std::vector<std::string>;

/// Quotes words for a POSIX shell: those with anything but letters, digits and "_-./:=,+@%" in single quotes.
std::string shell_line(const ProgramWords& words);

}  // namespace hapbench
