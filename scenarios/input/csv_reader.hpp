#pragma once

#include <filesystem>

#include "scenarios/input/text_lines.hpp"

namespace hapbench {

/// The rows of a comma-separated table, one by one. Cells have no quotes; white space around them, a carriage return at
/// the end of the line included, does not belong to them.
class CsvReader {
 public:
  /// Takes the next line for the header; an empty one when there is none. The text and the path must outlive the
  /// reader.
  CsvReader(LineReader lines, const std::filesystem::path& file);

  /// The header's line.
  std::string_view header() const { return header_; }
  const Words& columns() const { return columns_; }

  /// Goes to the next row; false at the end. Throws InputError when it has more or fewer cells than there are columns.
  bool next();
  /// The same, blank lines passed over.
  bool next_not_blank();
  std::string_view row() const { return row_; }
  const Words& cells() const { return cells_; }
  /// Number, from 1, of the row's line in the file.
  std::size_t line() const { return lines_.line(); }

 private:
  LineReader lines_;
  const std::filesystem::path& file_;
  std::string_view header_, row_;
  Words columns_, cells_;
};

}  // namespace hapbench
