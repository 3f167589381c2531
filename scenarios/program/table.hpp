#pragma once

#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Text for the terminal: the width of the output, tables, wrapped prose.
namespace hapbench {

/// The width of standard output [characters]: COLUMNS of the environment, else that of the terminal; unbounded in a
/// pipe or a file, and after `output_in_full`.
std::size_t output_width();

/// The width of prose: that of the output, but at most 100.
std::size_t prose_width();
/// Makes the output unbounded (--wide).
void output_in_full();
bool output_is_in_full();

/// Breaks lines that are wider than the output at blanks; continuations are indented by two more blanks. A word is
/// never broken.
std::string fitted(std::string_view text, std::size_t width = output_width());

/// The text in bold where the stream is a terminal, unless NO_COLOR is set or TERM is "dumb".
std::string bold(std::FILE* stream, std::string_view text);

/// A table for the terminal: columns as wide as their widest cell, a rule under the header. Numbers are aligned right,
/// text left. A title may have two lines.
class Table {
 public:
  struct Column {
    std::string title;
    bool number = true;        ///< aligned as one
    std::string meaning = {};  ///< for `describe`: a name that it knows or a sentence; empty: it knows the title itself
  };

  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  /// Precondition: one cell per column.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// The table in at most `most_width` characters: a last column of text is wrapped; other columns that do not fit
  /// follow below, in blocks that each begin with the first column.
  std::string text(std::size_t most_width = output_width()) const;
  /// Length of the longest line, in full.
  std::size_t width() const;

 private:
  std::vector<std::size_t> widths() const;
  std::string block(const std::vector<std::size_t>& widths, const std::vector<std::size_t>& columns) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Prose of at most `width` characters a line, each behind `indent` blanks; line breaks stay.
std::string wrapped(std::string_view text, std::size_t indent = 2, std::size_t width = prose_width());

/// A name behind `indent` blanks with its meaning beside it, from `column` on, or below it where the name is too long.
std::string entry(std::string_view name, std::string_view meaning, std::size_t indent = 2, std::size_t column = 26,
                  std::size_t width = prose_width());

/// A number with `digits` significant digits; "-" for NaN, infinities and none.
std::string significant(double value, int digits = 4);
std::string significant(const std::optional<double>& value, int digits = 4);
/// How many of `most` significant digits a tolerance leaves a number, one at least: down to its own leading one.
int deserved_digits(double value, const std::optional<double>& tolerance, int most);
/// A number with the digits that its tolerance (> 0) leaves it: down to the tolerance's leading one, and without an
/// exponent above 1e-4. `digits` significant ones where no tolerance is known, or it is larger than the number.
std::string deserved(double value, const std::optional<double>& tolerance, int digits = 4);

}  // namespace hapbench
