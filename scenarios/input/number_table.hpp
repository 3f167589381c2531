#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenarios/input/text_lines.hpp"

/// Tables of separated values, with a header of column names.
namespace hapbench {

/// Separators of cells. ' ' stands for any white space.
inline constexpr char kSeparators[] = {',', ';', '\t', ' '};

/// Splits a row into cells. Removes white space around a cell, then double quotes around it. A separator between
/// quotes does not separate.
void split_cells(std::string_view row, char separator, Words& cells);

/// Returns the most likely separator of a header: the first of ';', tab and ',' that occurs in the header. If none of
/// them occurs, returns ' ' (white space) for several words, and ',' for a single word.
char separator_in(std::string_view header);

/// Returns true if a line begins with '#' or '%', or if it names the separator for a spreadsheet ("sep=;"). Leading
/// white space is ignored.
bool is_comment(std::string_view line);

/// Returns the likely cause of a row with a wrong number of cells, beginning with "; ". Empty if the cause is not
/// known.
std::string cause_of_cell_count(std::string_view row, char separator, std::size_t cells, std::size_t columns);

/// Returns true for a number whose decimal separator is a comma, such as "0,002" or "-1,5e-3".
bool has_decimal_comma(std::string_view cell);

/// Returns "; write an exponent as in 1e-3" for a number such as "1.5D-03", as Fortran writes it; otherwise empty.
std::string cause_of_exponent(std::string_view cell);

/// Collects the first fault of a table and the number of rows with faults. A table with a fault in every row thus
/// causes a single message.
class RowFaults {
 public:
  /// Adds the fault of a row. Only the text of the first fault is kept, and a row with several faults counts once.
  /// `line` is 0 in a binary file. `entry` names what the row contains, such as "sample 3"; it may be empty.
  void add(std::size_t line, const std::string& problem, const std::string& entry = "");
  bool any() const { return count_ > 0; }
  /// If a fault was added, throws InputError with the line of the first fault and the number of further rows with
  /// faults.
  void throw_if_any(const std::filesystem::path& file) const;

 private:
  std::size_t line_ = 0, last_line_ = 0, count_ = 0;
  std::string problem_, entry_;
};

/// Column names of a header, split by the separator that gives the largest number of expected names.
struct HeaderNames {
  Words names;
  char separator = ',';
  std::size_t expected = 0;  ///< number of `names` that are expected
};

/// Reads a table row by row.
///
/// Separators are commas, semicolons, tabs or white space, the same in all rows. Cells may have double quotes. Blank
/// lines and comments (is_comment()) are skipped. The header is the first line that is neither blank nor a comment. If
/// this line has no expected name, the last comment above it that has an expected name is the header. If no such
/// comment exists either, the reader searches the next 20 lines, up to a line that begins with a number, for a header
/// with two expected names. A separator at the end of the header or of a row is ignored.
class CsvReader {
 public:
  /// Reads the header. `expected`: names of columns, by which the reader finds the header and its separator. If
  /// `expected` is empty, the header is the first line, the separator is a comma, and no line is a comment. The text
  /// and the path must outlive the reader.
  CsvReader(LineReader lines, const std::filesystem::path& file, std::span<const std::string_view> expected = {});

  /// Returns the names in the header; a single empty name if the text has no header.
  const Words& columns() const { return columns_; }
  std::size_t header_line() const { return header_line_; }  ///< line number of the header, from 1; 0 without header
  char separator() const { return separator_; }
  /// Returns a note about lines above the header that are not comments, such as a title; nothing if there are no such
  /// lines.
  std::optional<std::string> note_of_lines_above() const;

  /// Advances to the next row and returns true, or returns false at the end of the text.
  /// Throws InputError if the number of cells differs from the number of columns.
  bool next();
  /// Advances like next(), but does not throw. For a row with a wrong number of cells, has_all_cells() returns false.
  bool advance();
  bool has_all_cells() const { return cells_.size() == columns_.size(); }
  /// Returns the error message for the current row. Precondition: !has_all_cells().
  std::string cell_count_problem() const;

  /// Returns the cells of the current row.
  const Words& cells() const { return cells_; }
  /// Returns the line number of the current row in the file, from 1.
  std::size_t line() const { return lines_.line(); }

 private:
  void find_header(std::span<const std::string_view> expected);
  /// If one of the next lines is a header with expected names, replaces `header` by this header. Precondition: `header`
  /// has no expected names.
  void skip_lines_above_header(std::span<const std::string_view> expected, HeaderNames& header);
  void split(std::string_view row);
  /// Finds the separator of the rows, which may differ from the separator of the header.
  void find_separator_of_rows(std::string_view row);

  LineReader lines_;
  const std::filesystem::path& file_;
  std::string_view row_;
  char separator_ = ',';
  bool has_comments_ = false;  ///< true: comments are skipped
  bool is_first_row_ = true;
  std::size_t header_line_ = 0, first_line_above_ = 0, lines_above_ = 0;
  Words columns_, cells_;
};

/// A quantity of a table, such as a position. Its components are columns with fixed names.
struct TableQuantity {
  /// Alternative lists of column names. A table has the columns of exactly one of these lists.
  std::vector<std::vector<std::string_view>> alternatives;
  bool is_optional = false;  ///< true: a table may lack the quantity
};

/// The numbers of a table, as a matrix.
struct NumberTable {
  std::size_t columns = 0;
  /// Row by row (row-major). The columns have the order of the quantities, whatever their order in the file.
  std::vector<double> values;
  /// For each quantity: index of the alternative whose columns the table has; empty if the table lacks the quantity.
  std::vector<std::optional<std::size_t>> chosen;
  /// One sentence for each thing that the reader ignored or assumed, beginning with the line: "line 1: …".
  std::vector<std::string> notes;
  /// Index and line of each row whose line does not directly follow the line of the previous row.
  std::vector<std::pair<std::size_t, std::size_t>> line_jumps;

  std::size_t rows() const { return columns == 0 ? 0 : values.size() / columns; }
  std::span<const double> row(std::size_t i) const { return {values.data() + i * columns, columns}; }
  /// Returns the line of a row in the file, from 1.
  std::size_t line_of(std::size_t row) const;
};

/// Parses the contents of a file of numbers. Finds columns by their names. Ignores other columns, and reports them in
/// the notes. Numbers may have a decimal comma if another character separates the cells; a note then reports the comma.
/// Throws InputError with file and line if a column is missing or named twice, if a row has the wrong number of
/// cells, if a cell is not a finite number, or if there are more than `max_rows` rows.
NumberTable parse_number_table(std::string_view text, const std::filesystem::path& file,
                               std::span<const TableQuantity> quantities, std::size_t max_rows);

}  // namespace hapbench
