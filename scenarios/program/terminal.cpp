#include "scenarios/program/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace hapbench {
namespace {

/// Narrower ones would not hold a name and its meaning.
constexpr std::size_t kNarrowest = 40;

bool in_full = false;

}  // namespace

std::size_t output_width() {
  if (in_full) return std::string::npos;
  const char* columns = std::getenv("COLUMNS");
  if (const long given = columns == nullptr ? 0 : std::atol(columns); given > 0)
    return std::max(kNarrowest, static_cast<std::size_t>(given));
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return std::string::npos;
  return std::max<std::size_t>(kNarrowest, size.ws_col);
}

std::size_t prose_width() {
  return std::min(output_width(), kTableWidth);
}

void output_in_full() {
  in_full = true;
}

std::string fitted(std::string_view text, std::size_t width) {
  std::string all;
  while (!text.empty()) {
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

}  // namespace hapbench
