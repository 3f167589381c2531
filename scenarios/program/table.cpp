#include "scenarios/program/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <sstream>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/text.hpp"

namespace hapbench {

namespace {

constexpr std::size_t kGap = 2;  ///< spaces between columns

/// Returns the width of each column: the width of its title or of its widest cell, whichever is larger.
std::vector<std::size_t> widths_of(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const auto [upper, lower] = table.columns[c].lines();
    std::size_t width = std::max(upper.size(), lower.size());
    for (const auto& row : table.rows) width = std::max(width, row[c].size());
    widths.push_back(width);
  }
  return widths;
}

/// Returns the columns with these indices side by side, under their header. Wraps the cells of the last column to its
/// width.
std::string block_text(const Table& table, const std::vector<std::size_t>& widths,
                       const std::vector<std::size_t>& indices) {
  const auto line = [&](auto cell_of) {
    std::string text;
    for (const std::size_t c : indices) {
      const std::string cell = cell_of(c);
      text += table.columns[c].number ? fmt::format("{:>{}}", cell, widths[c]) : fmt::format("{:<{}}", cell, widths[c]);
      text.append(kGap, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = line([&](std::size_t c) { return table.columns[c].lines()[0]; });
  if (text == "\n") text.clear();
  text += line([&](std::size_t c) { return table.columns[c].lines()[1]; });
  text += line([&](std::size_t c) { return std::string(widths[c], '-'); });
  // Write the rows, each with as many lines as its wrapped last cell.
  for (const auto& row : table.rows) {
    const std::size_t last = indices.back();
    std::istringstream prose(wrapped(row[last], 0, widths[last]));
    bool first = true;
    for (std::string part; std::getline(prose, part); first = false) {
      text += line([&](std::size_t c) {
        if (c == last) return part;
        return first ? row[c] : std::string();
      });
    }
  }
  return text;
}

}  // namespace

std::array<std::string, 2> Table::Column::lines() const {
  const std::size_t end = title.find('\n');
  if (end == std::string::npos) return {"", title};
  return {title.substr(0, end), title.substr(end + 1)};
}

std::array<std::string, 2> Table::Column::head_lines() const {
  auto [upper, lower] = lines();
  const std::string line = upper + " " + lower;
  const auto words = words_of(line);
  const bool has_unit = unit.empty() || unit == "1" || title.find('[') != std::string::npos ||
                        std::ranges::find(words, unit) != words.end();
  if (!has_unit) lower += fmt::format(" [{}]", unit);
  return {upper, lower};
}

std::string Table::Column::head() const {
  const auto [upper, lower] = head_lines();
  return upper.empty() || upper.ends_with('-') ? upper + lower : upper + " " + lower;
}

std::string Table::text(std::size_t max_width) const {
  constexpr std::size_t kMinProseWidth = 24;
  std::vector<std::size_t> widths = widths_of(*this);
  const std::size_t others = std::accumulate(widths.begin(), widths.end() - 1, kGap * (widths.size() - 1));
  if (others + widths.back() > max_width && columns.size() > 1 && !columns.back().number) {
    // If the last column does not fit beside the others, print it beside the first column in a separate block.
    const std::size_t beside = others + kMinProseWidth <= max_width ? others : widths[0] + kGap;
    const std::size_t rest = std::max(kMinProseWidth, max_width - std::min(max_width, beside));
    widths.back() = std::min(widths.back(), rest);
  }
  std::string text;
  // Fill blocks with columns, each block beginning with the first column.
  std::vector<std::size_t> indices = {0};
  std::size_t width = widths[0];
  for (std::size_t c = 1; c < columns.size(); ++c) {
    if (indices.size() > 1 && width + kGap + widths[c] > max_width) {
      text += block_text(*this, widths, indices) + "\n";
      indices = {0};
      width = widths[0];
    }
    indices.push_back(c);
    width += kGap + widths[c];
  }
  return text + block_text(*this, widths, indices);
}

}  // namespace hapbench
