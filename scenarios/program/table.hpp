#pragma once

#include <array>
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
    std::string unit = {};     ///< unit of numbers; empty or "1": none, or it is part of the title

    /// Returns the upper and the lower line of the title. A title of one line is the lower line.
    std::array<std::string, 2> lines() const;
    /// Returns lines() with the unit in brackets at the end. Adds no unit if the title already has the unit as a word,
    /// or contains a bracket.
    std::array<std::string, 2> head_lines() const;
    /// Returns head_lines() as one line.
    std::string head() const;
  };
  std::vector<Column> columns = {};
  std::vector<std::vector<std::string>> rows = {};  ///< each row has a cell for each column
  std::string caption = {};                         ///< what the table shows; not part of text()

  /// Returns the table with lines of at most `max_width` characters. A last column of text is wrapped. Other
  /// columns that do not fit follow in blocks below, which each begin with the first column.
  std::string text(std::size_t max_width) const;
};

}  // namespace hapbench
