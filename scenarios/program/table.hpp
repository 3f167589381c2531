#pragma once

#include <string>
#include <string_view>
#include <vector>

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
  /// Columns that do not fit into `most_width` characters follow below, in blocks that each begin with the first
  /// column.
  std::string text(std::size_t most_width = std::string::npos) const;
  /// Length of the longest line, blocks aside.
  std::size_t width() const;

 private:
  std::vector<std::size_t> widths() const;
  std::string block(const std::vector<std::size_t>& widths, const std::vector<std::size_t>& columns) const;

  std::vector<Column> columns_;
  std::size_t gap_;
  std::vector<std::vector<std::string>> rows_;
};

/// Prose of at most `width` columns a line, each behind `indent` spaces.
std::string wrapped(std::string_view text, std::size_t indent = 2, std::size_t width = 100);

/// Tables aim at this width [characters].
inline constexpr std::size_t kTableWidth = 100;

/// A number for people: `digits` significant ones, "-" for none.
std::string significant(double value, int digits = 4);

}  // namespace hapbench
