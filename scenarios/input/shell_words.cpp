#include "scenarios/input/shell_words.hpp"

#include <string_view>

namespace hapbench {

std::string shell_word(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  // zsh replaces a word that begins with '=' by the path of a command.
  const bool is_plain = !text.empty() && !text.starts_with('=') && text.find_first_not_of(kPlain) == std::string::npos;
  if (is_plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string shell_file(const std::filesystem::path& file) {
  const std::string text = file.string();
  return shell_word(text.starts_with('-') ? "./" + text : text);
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

}  // namespace hapbench
