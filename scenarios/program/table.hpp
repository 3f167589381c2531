#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/program/terminal.hpp"

namespace hapbench {

/// A table for the terminal: columns as wide as their widest cell, a rule under the header. Numbers to the right, text
/// to the left. A title may have two lines.
class Table {
 public:
  /// One column: its title, and whether its cells are numbers.
  struct Column {
    std::string title;
    bool number = true;
  };

  /// `gap`: blanks between columns.
  explicit Table(std::vector<Column> columns, std::size_t gap = 2);
  /// Precondition: one cell per column.
  void add(std::vector<std::string> cells);
  /// The table in at most `most_width` characters: a last column of text is wrapped; other columns that do not fit
  /// follow below, in blocks that each begin with the first column.
  std::string text(std::size_t most_width = output_width()) const;
  /// Length of the longest line, in full.
  std::size_t width() const;

 private:
  std::vector<std::size_t> widths() const;
  std::string block(const std::vector<std::size_t>& widths, const std::vector<std::size_t>& columns) const;

  std::vector<Column> columns_;
  std::size_t gap_;
  std::vector<std::vector<std::string>> rows_;
};

/// Prose of at most `width` characters a line, each behind `indent` blanks; line breaks stay.
std::string wrapped(std::string_view text, std::size_t indent = 2, std::size_t width = prose_width());

/// A name behind `indent` blanks and what it means beside it, from `column` on; below it where the name is too long.
std::string entry(std::string_view name, std::string_view meaning, std::size_t indent = 2, std::size_t column = 26,
                  std::size_t width = prose_width());

/// A number for people: `digits` significant ones, "-" for none.
std::string significant(double value, int digits = 4);

}  // namespace hapbench
