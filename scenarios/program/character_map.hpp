#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace hapbench {

/// The axis below a map: what it is, and its ends.
struct MapColumns {
  std::string name;
  std::size_t count = 0;
  std::string low;
  std::string high;
};

/// A map for the terminal, a character for each cell, rows upwards: row 0 is the lowest. `row_labels` has a text, which
/// may be empty, for each row.
std::string character_map(const MapColumns& columns, const std::string& row_name,
                          const std::vector<std::string>& row_labels,
                          const std::function<char(std::size_t column, std::size_t row)>& cell);

}  // namespace hapbench
