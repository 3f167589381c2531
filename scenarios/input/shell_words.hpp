#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Quotes the words of printed commands, so that users can paste them.
namespace hapbench {

/// Returns a text as a word for a POSIX shell. The word is in single quotes if the text is empty, begins with "=", or
/// has characters other than letters, digits and "_-./:=,+@%".
std::string shell_word(const std::string& text);

/// Returns the path of a file or folder as a word for a POSIX shell. A leading "-" becomes "./-", so that no command
/// takes the file for an option.
std::string shell_file(const std::filesystem::path& file);

/// Returns a command line: the words, quoted by shell_word() and separated by blanks.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace hapbench
