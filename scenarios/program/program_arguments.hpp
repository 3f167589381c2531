#pragma once

#include <string>
#include <vector>

namespace hapbench {

/// The arguments of a command line after the program's name.
using ProgramArguments = std::vector<std::string>;

}  // namespace hapbench
