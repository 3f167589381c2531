#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hapbench {

/// A table for the terminal. Each column is as wide as its widest cell, with a rule under the header. Numbers
/// are aligned right, text left. A title may have two lines.
struct Table {
  struct Column {
    std::string title;
    bool number = true;        ///< true: aligned right; false: text, aligned left
    std::string meaning = {};  ///< for `describe`: a name that it explains, or a sentence; empty: the title
  };
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows = {};  ///< each row has a cell for each column

  /// Returns the table with lines of at most `max_width` characters. A last column of text is wrapped. Other
  /// columns that do not fit follow in blocks below, which each begin with the first column.
  std::string text(std::size_t max_width) const;
};

}  // namespace hapbench
