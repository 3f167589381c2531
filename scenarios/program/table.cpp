#include "scenarios/program/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace hapbench {

Table::Table(std::vector<Column> columns, std::size_t gap) : columns_(std::move(columns)), gap_(gap) {}

void Table::add(std::vector<std::string> cells) {
  rows_.push_back(std::move(cells));
}

namespace {

/// The upper and the lower line of a title; one line is the lower.
std::array<std::string, 2> title_lines(const std::string& title) {
  const std::size_t end = title.find('\n');
  return end == std::string::npos ? std::array<std::string, 2>{"", title}
                                  : std::array<std::string, 2>{title.substr(0, end), title.substr(end + 1)};
}

}  // namespace

std::vector<std::size_t> Table::widths() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto [upper, lower] = title_lines(columns_[c].title);
    std::size_t width = std::max(upper.size(), lower.size());
    for (const auto& row : rows_) width = std::max(width, row[c].size());
    widths.push_back(width);
  }
  return widths;
}

std::size_t Table::width() const {
  std::size_t sum = 0;
  for (const std::size_t width : widths()) sum += width + gap_;
  return sum - gap_;
}

std::string Table::block(const std::vector<std::size_t>& widths, const std::vector<std::size_t>& columns) const {
  const auto line = [&](auto cell_of) {
    std::string text;
    for (const std::size_t c : columns) {
      const std::string cell = cell_of(c);
      text += columns_[c].number ? fmt::format("{:>{}}", cell, widths[c]) : fmt::format("{:<{}}", cell, widths[c]);
      text.append(gap_, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = line([&](std::size_t c) { return title_lines(columns_[c].title)[0]; });
  if (text == "\n") text.clear();
  text += line([&](std::size_t c) { return title_lines(columns_[c].title)[1]; });
  text += line([&](std::size_t c) { return std::string(widths[c], '-'); });
  for (const auto& row : rows_) {
    const std::size_t last = columns.back();
    if (row[last].size() <= widths[last]) {
      text += line([&](std::size_t c) { return row[c]; });
      continue;
    }
    std::istringstream prose(wrapped(row[last], 0, widths[last]));
    bool first = true;
    for (std::string part; std::getline(prose, part); first = false) {
      text += line([&](std::size_t c) { return c == last ? part : first ? row[c] : ""; });
    }
  }
  return text;
}

std::string Table::text(std::size_t most_width) const {
  constexpr std::size_t kNarrowestProse = 24;
  std::vector<std::size_t> width_of = widths();
  const std::size_t full = width();
  if (full > most_width && columns_.size() > 1 && !columns_.back().number) {
    const std::size_t others = full - width_of.back();
    // In a block of its own it stands beside the first column.
    const std::size_t beside = others + kNarrowestProse <= most_width ? others : width_of[0] + gap_;
    const std::size_t rest = std::max(kNarrowestProse, most_width - std::min(most_width, beside));
    width_of.back() = std::min(width_of.back(), rest);
  }
  std::string text;
  std::vector<std::size_t> columns = {0};
  std::size_t width = width_of[0];
  for (std::size_t c = 1; c < columns_.size(); ++c) {
    if (columns.size() > 1 && width + gap_ + width_of[c] > most_width) {
      text += block(width_of, columns) + "\n";
      columns = {0};
      width = width_of[0];
    }
    columns.push_back(c);
    width += gap_ + width_of[c];
  }
  return text + block(width_of, columns);
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

std::string significant(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : "-";
}

}  // namespace hapbench
