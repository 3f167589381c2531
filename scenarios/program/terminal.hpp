#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

/// What standard output goes to, and what fits there.
namespace hapbench {

/// Tables aim at this width, and prose is never wider [characters].
inline constexpr std::size_t kTableWidth = 100;

/// The width of standard output: COLUMNS of the environment, else that of the terminal; without bound in a pipe or a
/// file, and after `output_in_full`.
std::size_t output_width();

/// The width of prose: that of the output, but at most kTableWidth.
std::size_t prose_width();

/// Lets the output be as wide as it is (--wide).
void output_in_full();

/// The text with lines that are wider than the output broken at blanks; what follows a break stands two blanks further
/// in. A word is never broken.
std::string fitted(std::string_view text, std::size_t width = output_width());

/// The text in bold where the stream is a terminal, unless NO_COLOR is set or TERM is "dumb".
std::string bold(std::FILE* stream, std::string_view text);

}  // namespace hapbench
