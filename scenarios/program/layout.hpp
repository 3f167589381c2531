#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hapbench {

/// How wide the answer of a command is, and prose that is as wide.
class Layout {
 public:
  /// `width`: of a line [characters]. `in_full`: also the columns of tables that only --wide shows.
  explicit Layout(std::size_t width = std::string::npos, bool in_full = false) : width_(width), in_full_(in_full) {}
  /// The width of standard output: COLUMNS of the environment, else that of the terminal; unbounded in a pipe or a
  /// file, and `in_full`.
  static Layout of_output(bool in_full);

  std::size_t width() const { return width_; }
  /// The width of prose: that of a line, but at most 100.
  std::size_t prose_width() const;
  bool in_full() const { return in_full_; }

  /// hapbench::wrapped and hapbench::entry in the width of prose.
  std::string wrapped(std::string_view text, std::size_t indent = 2) const;
  std::string entry(std::string_view name, std::string_view meaning, std::size_t indent = 2,
                    std::size_t column = 26) const;

 private:
  std::size_t width_;
  bool in_full_;
};

}  // namespace hapbench
