#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

/// Reads a table of cases line by line, whether the table is complete or truncated.
namespace hapbench {

/// Reads the complete lines of a table: the header, then the rows. Each row begins with the number of its case.
class TableLines {
 public:
  /// `cases`: number of cases; every row number must be smaller. A file that does not exist has no lines.
  TableLines(const std::filesystem::path& file, std::size_t cases);

  /// Reads the next line. Returns false at the end of the file, and if the last line has no newline.
  bool next();
  /// Returns the line that next() read, without its newline.
  const std::string& line() const { return line_; }
  /// Returns the offset of the start of this line in the file [bytes].
  std::uintmax_t begin() const { return begin_; }
  /// Returns the offset of the end of the last complete line that next() has read [bytes].
  std::uintmax_t end() const { return end_; }
  /// Returns the number of the case in this row. Throws InputError.
  std::size_t row() const;
  /// Throws InputError with `problem`, the file and the number of this line.
  [[noreturn]] void refuse(const std::string& problem) const;
  /// Throws InputError with the message that this line is not a row of the table.
  [[noreturn]] void refuse() const;

 private:
  std::filesystem::path file_;
  std::size_t cases_;
  std::ifstream in_;
  std::string line_;
  std::uintmax_t begin_ = 0, end_ = 0;
  std::size_t number_ = 0;  ///< number of this line, counted from 1
};

}  // namespace hapbench
