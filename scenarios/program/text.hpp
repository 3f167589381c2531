#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

/// Prose for the terminal.
namespace hapbench {

/// The width of standard output [characters]: COLUMNS of the environment, else that of the terminal; unbounded in a
/// pipe or a file, and when `output_in_full`.
std::size_t output_width();
/// The option --wide.
bool& output_in_full();
/// The width of prose: that of the output, but at most 100.
std::size_t prose_width();

/// Breaks lines wider than the output at blanks, never within a word; continuations are indented by two more blanks.
std::string fitted(std::string_view text, std::size_t width = output_width());

/// The text in bold where the stream is a terminal, unless NO_COLOR is set or TERM is "dumb".
std::string bold(std::FILE* stream, std::string_view text);

/// Prose of at most `width` characters a line, each behind `indent` blanks; line breaks stay.
std::string wrapped(std::string_view text, std::size_t indent = 2, std::size_t width = prose_width());

/// A name behind `indent` blanks with its meaning beside it, from `column` on, or below it where the name is too long.
std::string entry(std::string_view name, std::string_view meaning, std::size_t indent = 2, std::size_t column = 26,
                  std::size_t width = prose_width());

}  // namespace hapbench
