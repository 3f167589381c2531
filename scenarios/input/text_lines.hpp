#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Text files taken apart: lines, words, numbers, and tables of comma-separated values.
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

/// The rows of a comma-separated table, one by one. Cells have no quotes, and white space around them does not count.
class CsvReader {
 public:
  /// Takes the next line, if there is one, for the header. The text and the path must outlive the reader.
  CsvReader(LineReader lines, const std::filesystem::path& file);

  std::string_view header() const { return header_; }  ///< the line
  const Words& columns() const { return columns_; }

  /// Goes to the next row; false at the end. Blank lines are skipped. Throws InputError when it has more or fewer cells
  /// than there are columns.
  bool next();
  const Words& cells() const { return cells_; }
  /// Number, from 1, of the row's line in the file.
  std::size_t line() const { return lines_.line(); }

 private:
  LineReader lines_;
  const std::filesystem::path& file_;
  std::string_view header_;
  Words columns_, cells_;
};

/// The bytes of a file that a scenario names. Throws InputError that names the file.
std::string read_named_file(const std::filesystem::path& file);

/// The numbers of a CSV file.
struct NumberTable {
  std::size_t columns = 0;
  std::vector<double> values;  ///< row by row

  std::size_t rows() const { return columns == 0 ? 0 : values.size() / columns; }
  std::span<const double> row(std::size_t i) const { return {values.data() + i * columns, columns}; }
};

/// Reads the contents of a CSV file of numbers. The first line must be exactly one of `headers`; blank lines are
/// skipped. Throws InputError that names file, line and column for another header, a wrong number of cells, a cell that
/// is not a finite number, or more than `most_rows` rows.
NumberTable number_table_in(std::string_view text, const std::filesystem::path& file,
                            std::initializer_list<std::string_view> headers, std::size_t most_rows);

}  // namespace hapbench
