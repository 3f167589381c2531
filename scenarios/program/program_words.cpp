#include "scenarios/program/program_words.hpp"

#include <string_view>

namespace hapbench {

std::string shell_line(const ProgramWords& words) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    const bool is_plain = !word.empty() && word.find_first_not_of(kPlain) == std::string::npos;
    if (!is_plain) line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    if (!is_plain) line += '\'';
  }
  return line;
}

}  // namespace hapbench
