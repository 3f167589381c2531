#pragma once

#include <span>
#include <string_view>

/// The list of the commands. Each command is defined in a source file or folder with the command's name.
namespace hapbench {

class CommandLine;

using AddCommand = void(CommandLine& line);

/// A command: its group, its name, its texts in the help, and the function that adds it to the command line.
struct CommandGuide {
  std::string_view group, name, purpose;
  AddCommand* add;                 ///< null if a Python package implements the command
  std::string_view examples = {};  ///< one example per line
  std::string_view manual = {};    ///< page and section of the manual that explains the command in full
};

/// Returns all commands in the order of the program's help.
std::span<const CommandGuide> command_guides();

}  // namespace hapbench
