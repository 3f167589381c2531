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
