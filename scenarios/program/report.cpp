#include "scenarios/program/report.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <sstream>

namespace hapbench {
namespace {

/// A narrower output would not hold a name and its meaning.
constexpr std::size_t kNarrowest = 40;
constexpr std::size_t kGap = 2;  ///< blanks between columns

/// The upper and the lower line of a title; a single line is the lower one.
std::array<std::string, 2> title_lines(const std::string& title) {
  const std::size_t end = title.find('\n');
  if (end == std::string::npos) return {"", title};
  return {title.substr(0, end), title.substr(end + 1)};
}

std::vector<std::size_t> widths_of(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const auto [upper, lower] = title_lines(table.columns[c].title);
    std::size_t width = std::max(upper.size(), lower.size());
    for (const auto& row : table.rows) width = std::max(width, row[c].size());
    widths.push_back(width);
  }
  return widths;
}

/// The columns of these places side by side, under their header. The last one is wrapped where it is wider.
std::string block_text(const Table& table, const std::vector<std::size_t>& widths,
                       const std::vector<std::size_t>& places) {
  const auto line = [&](auto cell_of) {
    std::string text;
    for (const std::size_t c : places) {
      const std::string cell = cell_of(c);
      text += table.columns[c].number ? fmt::format("{:>{}}", cell, widths[c]) : fmt::format("{:<{}}", cell, widths[c]);
      text.append(kGap, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = line([&](std::size_t c) { return title_lines(table.columns[c].title)[0]; });
  if (text == "\n") text.clear();
  text += line([&](std::size_t c) { return title_lines(table.columns[c].title)[1]; });
  text += line([&](std::size_t c) { return std::string(widths[c], '-'); });
  for (const auto& row : table.rows) {
    const std::size_t last = places.back();
    std::istringstream prose(wrapped(row[last], 0, widths[last]));
    bool first = true;
    for (std::string part; std::getline(prose, part); first = false)
      text += line([&](std::size_t c) { return c == last ? part : first ? row[c] : ""; });
  }
  return text;
}

}  // namespace

std::size_t output_width() {
  if (output_in_full()) return std::string::npos;
  const char* columns = std::getenv("COLUMNS");
  if (const long given = columns == nullptr ? 0 : std::atol(columns); given > 0)
    return std::max(kNarrowest, static_cast<std::size_t>(given));
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return std::string::npos;
  return std::max<std::size_t>(kNarrowest, size.ws_col);
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

std::string Table::text(std::size_t most_width) const {
  constexpr std::size_t kNarrowestProse = 24;
  std::vector<std::size_t> widths = widths_of(*this);
  const std::size_t others = std::accumulate(widths.begin(), widths.end() - 1, kGap * (widths.size() - 1));
  if (others + widths.back() > most_width && columns.size() > 1 && !columns.back().number) {
    // In a block of its own the last column stands beside the first.
    const std::size_t beside = others + kNarrowestProse <= most_width ? others : widths[0] + kGap;
    const std::size_t rest = std::max(kNarrowestProse, most_width - std::min(most_width, beside));
    widths.back() = std::min(widths.back(), rest);
  }
  std::string text;
  std::vector<std::size_t> places = {0};
  std::size_t width = widths[0];
  for (std::size_t c = 1; c < columns.size(); ++c) {
    if (places.size() > 1 && width + kGap + widths[c] > most_width) {
      text += block_text(*this, widths, places) + "\n";
      places = {0};
      width = widths[0];
    }
    places.push_back(c);
    width += kGap + widths[c];
  }
  return text + block_text(*this, widths, places);
}

std::string wrapped(std::string_view text, std::size_t indent, std::size_t width) {
  std::string lines;
  std::size_t column = 0;
  bool begins_line = true;
  while (!text.empty()) {
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
