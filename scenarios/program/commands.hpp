#pragma once

#include <span>
#include <string_view>

/// The list of the commands. Each command is defined in a source file or folder with the command's name.
namespace hapbench {

class CommandLine;

using AddCommand = void(CommandLine& line);

/// A command in the program's help, and in its own.
struct CommandGuide {
  std::string_view group, name, purpose;
  AddCommand* add;                 ///< null: of a Python package
  std::string_view examples = {};  ///< a line each
  std::string_view manual = {};    ///< page and section of the manual with the rest
};

/// Returns all commands in the order of the program's help.
std::span<const CommandGuide> command_guides();

}  // namespace hapbench
