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

/// Splitting of texts into lines and tokens, and conversion of tokens to numbers.
namespace hapbench {

/// Tokens of a text. They refer to the text, which must outlive them.
using Words = std::vector<std::string_view>;

/// Returns true for white space within a line.
inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Splits a line into tokens at white space.
Words words_of(std::string_view line);
/// Replaces `words` by the tokens of a line. Reuses the memory of `words`.
void split_at_blanks(std::string_view line, Words& words);

/// Splits a text at each separator. Parts may be empty. There is one part more than there are separators.
Words parts_of(std::string_view text, char separator);

/// Returns the text without white space at both ends.
std::string_view trimmed(std::string_view text);

/// Converts a token to a finite number. Returns nullopt if the token is anything else.
std::optional<double> finite_number(std::string_view word);

/// Converts a token to a number of type Number. Returns nullopt if a part of the token does not belong to the number,
/// or if the number is out of range.
template <class Number>
std::optional<Number> parse_number(std::string_view word) {
  Number value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Converts a token to an integer >= 0. Returns nullopt if the token is anything else.
inline std::optional<std::size_t> whole_number(std::string_view word) {
  return parse_number<std::size_t>(word);
}

/// Returns a token in the form for error messages: in quotes, with escaped control characters, truncated if it is
/// long.
std::string quoted_token(std::string_view word);

/// Returns the text with its ASCII letters in lower case.
std::string lower_case(std::string_view text);

/// Returns true if `byte` is the first byte of a character (code point) in UTF-8.
inline bool starts_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}
/// Returns the number of characters (code points) in a UTF-8 text.
inline std::size_t count_characters(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, starts_character));
}

/// Returns a warning if the last line of a text has no line end although an earlier line has one, as if the file was
/// cut within its last line. Returns an empty text otherwise.
std::string warning_of_cut_line(std::string_view text);

/// Returns the name of each entry of a table. `name` is a pointer to a member of the entry or a function of the
/// entry. Entries may be pointers.
template <class Table, class Name>
std::vector<std::string> names_of(const Table& table, Name name) {
  std::vector<std::string> names;
  names.reserve(std::size(table));
  for (const auto& entry : table) names.emplace_back(std::invoke(name, entry));
  return names;
}

/// Returns the lines of a text one by one. The text must outlive the reader.
///
/// Skips a byte order mark (UTF-8) at the start of the text. A line ends with LF, CRLF or CR, so that the reader counts
/// lines as an editor does. If the first line ends with CR alone, every CR ends a line. An LF after a CR then belongs
/// to the next line, because it may be the first byte of binary data after a header.
class LineReader {
 public:
  explicit LineReader(std::string_view text);

  /// Returns the next line without its line end, or nullopt at the end of the text.
  std::optional<std::string_view> next();
  std::size_t line() const { return line_; }  ///< number of the last returned line, from 1; 0 before the first line
  std::string_view rest() const { return rest_; }  ///< the text after the last returned line
  /// Returns true if the last returned line has a line end. A text that was cut within its last line has no line end
  /// after this line.
  bool has_line_end() const { return has_line_end_; }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
  const char* newline_;  ///< position of the next LF; the end of the text if no LF is left
  bool ends_with_cr_;    ///< true: the first line ends with CR alone
  bool has_line_end_ = false;
};

/// Byte order mark of UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace hapbench
