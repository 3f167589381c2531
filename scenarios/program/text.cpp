#include "scenarios/program/text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace hapbench {

std::string fitted(std::string_view text, std::size_t width) {
  std::string all;
  while (!text.empty()) {
    // Take the next line, and break it at spaces while it is too long.
    const std::size_t length = std::min(text.find('\n'), text.size());
    std::string line(text.substr(0, length));
    text.remove_prefix(std::min(text.size(), length + 1));
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    while (line.size() > width) {
      const std::size_t blank = line.rfind(' ', width);
      if (blank == std::string::npos || blank <= indent + 2) break;
      all.append(line, 0, line.find_last_not_of(' ', blank) + 1).append("\n");
      line = std::string(indent + 2, ' ') + line.substr(blank + 1);
    }
    all += line + "\n";
  }
  return all;
}

std::string bold(std::FILE* stream, std::string_view text) {
  const char *no_color = std::getenv("NO_COLOR"), *term = std::getenv("TERM");
  const bool plain = (no_color != nullptr && *no_color != '\0') || (term != nullptr && std::strcmp(term, "dumb") == 0);
  if (plain || isatty(fileno(stream)) != 1) return std::string(text);
  return fmt::format("\033[1m{}\033[0m", text);
}

std::string with_unit(double number, std::string_view unit) {
  if (unit == "1") return fmt::format("{:g}", number);
  if (unit.substr(0, 2) == "1/") return fmt::format("{:g} per {}", number, unit.substr(2));
  return fmt::format("{:g} {}", number, unit);
}

std::string wrapped(std::string_view text, std::size_t indent, std::size_t width) {
  std::string lines;
  std::size_t column = 0;
  bool begins_line = true;
  while (!text.empty()) {
    // Take the next word, and put it on a new line if it does not fit.
    const std::string_view word = text.substr(0, text.find_first_of(" \n"));
    const bool ends_line = word.size() < text.size() && text[word.size()] == '\n';
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    if (begins_line || column + 1 + word.size() > width) {
      if (!lines.empty()) lines += '\n';
      if (!word.empty()) lines.append(indent, ' ');
      column = indent;
    } else {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += word.size();
    begins_line = ends_line;
  }
  return lines + "\n";
}

std::string entry(std::string_view name, std::string_view meaning, std::size_t indent, std::size_t column,
                  std::size_t width) {
  std::string text = wrapped(meaning, column, width);
  const std::string head = std::string(indent, ' ') + std::string(name);
  if (meaning.empty()) return head + "\n";
  if (head.size() + 2 > column) return head + "\n" + text;
  return text.replace(0, head.size(), head);
}

}  // namespace hapbench
