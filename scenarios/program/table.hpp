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
    bool number = true;  ///< true: aligned right; false: text, aligned left
    /// Meaning of the column for `describe`: a sentence, or a name that `describe` explains, such as the name of a
    /// metric. If empty, the title is the meaning.
    std::string meaning = {};
    /// Unit of the numbers. Empty or "1" if the numbers have no unit, or if the title contains the unit.
    std::string unit = {};

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

  /// Returns the table with lines of at most `max_width` characters. If the last column has text, its cells are
  /// wrapped. Other columns that do not fit are printed in further blocks below. Each block begins with the first
  /// column.
  std::string text(std::size_t max_width) const;
};

}  // namespace hapbench
