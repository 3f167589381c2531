#include "scenarios/program/program_arguments.hpp"

#include <string_view>

namespace hapbench {

std::string shell_line(const ProgramArguments& arguments) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  std::string line;
  for (const std::string& argument : arguments) {
    if (!line.empty()) line += ' ';
    const bool is_plain = !argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos;
    if (!is_plain) line += '\'';
    for (const char c : argument) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    if (!is_plain) line += '\'';
  }
  return line;
}

}  // namespace hapbench
