#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Quotes the words of printed commands, so that users can paste them.
namespace hapbench {

/// Returns a word for a POSIX shell. A word with characters other than letters, digits and "_-./:=,+@%", or with a
/// leading "=", is in single quotes.
std::string shell_word(const std::string& text);

/// Returns the word for a file or folder. A leading "-" becomes "./-", so that no command takes the file for an option.
std::string shell_file(const std::filesystem::path& file);

/// Returns a command line of these words.
std::string shell_line(const std::vector<std::string>& words);

}  // namespace hapbench
