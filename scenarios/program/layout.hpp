#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hapbench {

/// The width of printed text, and functions that wrap prose to it.
class Layout {
 public:
  /// `width` is the length of a line [characters]; npos: unlimited. `in_full` adds the table columns that only
  /// --wide shows.
  explicit Layout(std::size_t width = std::string::npos, bool in_full = false) : width_(width), in_full_(in_full) {}
  /// Returns the layout of standard output. With `in_full` its width is unlimited. Otherwise its width is the
  /// environment variable COLUMNS. If this variable is not set, the width is the width of the terminal, and unlimited
  /// if standard output is a pipe or a file.
  static Layout of_output(bool in_full);

  std::size_t width() const { return width_; }
  /// Returns the width of prose [characters]: width(), at most 100.
  std::size_t prose_width() const;
  bool in_full() const { return in_full_; }

  /// wrapped() and entry() call the functions of the same name in text.hpp with the width prose_width().
  std::string wrapped(std::string_view text, std::size_t indent = 2) const;
  std::string entry(std::string_view name, std::string_view meaning, std::size_t indent = 2,
                    std::size_t column = 26) const;

 private:
  std::size_t width_;
  bool in_full_;
};

}  // namespace hapbench
