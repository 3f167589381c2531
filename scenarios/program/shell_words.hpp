#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// Words as a POSIX shell takes them: those with anything but letters, digits and "_-./:=,+@%" in single quotes.
std::string shell_line(const std::vector<std::string>& words);

/// The file of this program.
std::filesystem::path this_program();

/// The options of a command line that load the plugins that this program has loaded.
std::vector<std::string> plugin_words();

/// What a program that ran to its end left.
struct ProgramOutput {
  int status = 0;    ///< exit status; 127 when there is no such program, 128 and more when a signal ended it
  std::string text;  ///< of standard output and standard error
};

/// Runs a program and waits for it. Throws IoError when no process can be started.
ProgramOutput output_of(const std::vector<std::string>& words);

/// Says what this_program answers, for code that runs in another one.
void set_this_program(std::filesystem::path program);

}  // namespace hapbench
