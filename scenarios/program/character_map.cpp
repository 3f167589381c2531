#include "scenarios/program/character_map.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hapbench {

std::string character_map(const MapColumns& columns, const std::string& row_name,
                          const std::vector<std::string>& row_labels,
                          const std::function<char(std::size_t column, std::size_t row)>& cell) {
  std::size_t width = 9;
  for (const std::string& label : row_labels) width = std::max(width, label.size());
  std::string text;
  for (std::size_t row = row_labels.size(); row-- > 0;) {
    text += fmt::format("  {:>{}}  ", row_labels[row], width);
    for (std::size_t column = 0; column < columns.count; ++column) text += {' ', cell(column, row)};
    text += row + 1 == row_labels.size() ? fmt::format("  {}\n", row_name) : "\n";
  }
  return text + fmt::format("{:{}}{} ... {}  {}\n", "", width + 4, columns.low, columns.high, columns.name);
}

}  // namespace hapbench
