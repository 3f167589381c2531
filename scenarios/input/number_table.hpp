#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "scenarios/input/text_lines.hpp"

/// Tables of comma-separated values.
namespace hapbench {

/// Reads a CSV (comma-separated values) table row by row. Cells are not quoted. White space around a cell is
/// ignored.
class CsvReader {
 public:
  /// Reads the header, which is the next line; without a next line the header is empty. The text and the path must
  /// outlive the reader.
  CsvReader(LineReader lines, const std::filesystem::path& file);

  std::string_view header() const { return header_; }  ///< the whole header line
  /// Returns the names in the header.
  const Words& columns() const { return columns_; }

  /// Advances to the next row and returns true, or returns false at the end of the text. Skips blank lines.
  /// Throws InputError if the number of cells differs from the number of columns.
  bool next();
  /// Returns the cells of the current row.
  const Words& cells() const { return cells_; }
  /// Returns the line number of the current row in the file, from 1.
  std::size_t line() const { return lines_.line(); }

 private:
  LineReader lines_;
  const std::filesystem::path& file_;
  std::string_view header_;
  Words columns_, cells_;
};

/// The numbers of a CSV file as a matrix.
struct NumberTable {
  std::size_t columns = 0;
  std::vector<double> values;  ///< row by row (row-major)

  std::size_t rows() const { return columns == 0 ? 0 : values.size() / columns; }
  std::span<const double> row(std::size_t i) const { return {values.data() + i * columns, columns}; }
};

/// Parses the contents of a CSV file of numbers. The first line must be equal to one of `headers`. Skips blank
/// lines. Throws InputError with file and line if the header is different, if a row has the wrong number of
/// cells, if a cell is not a finite number, or if there are more than `max_rows` rows.
NumberTable parse_number_table(std::string_view text, const std::filesystem::path& file,
                               std::initializer_list<std::string_view> headers, std::size_t max_rows);

}  // namespace hapbench
