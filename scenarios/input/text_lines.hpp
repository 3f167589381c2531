#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

/// Texts taken apart: lines, words and numbers.
namespace hapbench {

using Words = std::vector<std::string_view>;

/// The words of a line, separated by white space.
Words words_of(std::string_view line);

/// The parts of a text between separators, empty ones included; one more than there are separators.
Words parts_of(std::string_view text, char separator);

/// The whole word as a finite number, or none.
std::optional<double> finite_number(std::string_view word);

/// The whole word as a number of that type, or none.
template <class Number>
std::optional<Number> whole_word_as(std::string_view word) {
  Number value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The whole word as a count or index, or none.
inline std::optional<std::size_t> whole_number(std::string_view word) {
  return whole_word_as<std::size_t>(word);
}

/// The word as an error message shows it: in quotes, control characters escaped, cut when long.
std::string quoted_word(std::string_view word);

/// The text with its ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// True at the first byte of a character (code point) of UTF-8.
inline bool begins_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}
inline std::size_t characters_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

/// The names of a table's entries, or of what its pointers point to.
template <class Table, class Name>
std::vector<std::string> names_of(const Table& table, Name name) {
  std::vector<std::string> names;
  names.reserve(std::size(table));
  for (const auto& entry : table) names.emplace_back(std::invoke(name, entry));
  return names;
}

/// Returns the lines of a text one by one. The text must outlive it.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line without its end; none at the end of the text.
  std::optional<std::string_view> next();
  std::size_t line() const { return line_; }       ///< number, from 1, of the last line returned
  std::string_view rest() const { return rest_; }  ///< the text behind it

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

}  // namespace hapbench
