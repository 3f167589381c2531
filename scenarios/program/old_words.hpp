#pragma once

#include <string>
#include <string_view>

namespace hapbench {

/// What to write instead of a word that earlier versions took, such as the command "suite" or the option "--search" of
/// the command "stability"; empty when they did not. `command` is that of an option; empty for a command.
std::string_view instead_of(std::string_view command, std::string_view word);

}  // namespace hapbench
