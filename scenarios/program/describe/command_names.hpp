#pragma once

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

namespace hapbench {

/// Adds the commands of the program, each with its purpose and its page of the manual.
void add_commands(Index& index, const Layout& layout);

}  // namespace hapbench
