#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hapbench {

/// A table for the terminal: columns as wide as their widest cell, a rule under the header. Numbers are aligned right,
/// text left. A title may have two lines.
struct Table {
  struct Column {
    std::string title;
    bool number = true;        ///< aligned as one
    std::string meaning = {};  ///< for `describe`: a name that it knows or a sentence; empty: it knows the title itself
  };
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows = {};  ///< a cell for each column

  /// The table in at most `most_width` characters: a last column of text is wrapped; other columns that do not fit
  /// follow below, in blocks that each begin with the first column.
  std::string text(std::size_t most_width) const;
};

}  // namespace hapbench
