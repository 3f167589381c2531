#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

/// Prose for the terminal.
namespace hapbench {

/// Returns the text with lines of more than `width` characters broken at spaces, never within a word.
/// Continuation lines are indented by two more spaces.
std::string fitted(std::string_view text, std::size_t width);

/// Returns the text in bold if the stream is a terminal, NO_COLOR is not set and TERM is not "dumb".
std::string bold(std::FILE* stream, std::string_view text);

/// Returns a number and its unit as prose: "0.1", "2 N", or "10 per s" for the unit 1/s. The unit 1 is left out.
std::string with_unit(double number, std::string_view unit);

/// Returns prose with lines of at most `width` characters, indented by `indent` spaces. Keeps the line breaks
/// of the text.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t width);

/// Returns a name, indented by `indent` spaces, and its meaning. All lines of the meaning begin at the character
/// position `column`. If the name is too long, the meaning begins on the line below the name. Lines have at most
/// `width` characters.
std::string entry(std::string_view name, std::string_view meaning, std::size_t indent, std::size_t column,
                  std::size_t width);

}  // namespace hapbench
