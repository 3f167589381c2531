#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

/// Prose for the terminal.
namespace hapbench {

/// Breaks lines of more than `width` characters at blanks, never within a word; continuations are indented by two more
/// blanks.
std::string fitted(std::string_view text, std::size_t width);

/// The text in bold where the stream is a terminal, unless NO_COLOR is set or TERM is "dumb".
std::string bold(std::FILE* stream, std::string_view text);

/// Prose of at most `width` characters a line, each behind `indent` blanks; line breaks stay.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t width);

/// A name behind `indent` blanks with its meaning beside it, from `column` on, or below it where the name is too long.
std::string entry(std::string_view name, std::string_view meaning, std::size_t indent, std::size_t column,
                  std::size_t width);

}  // namespace hapbench
