#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// A comma-separated table with a header line, written row by row into an AtomicFile (RFC 4180, lines end in "\n").
/// Numbers are the shortest decimals that read back as the same double; 0 and -0 differ, non-finite ones are "inf",
/// "-inf" and "nan". Allocates in the constructor only; about 30 ns a number.
class CsvWriter {
 public:
  /// `header` is the first line, column names separated by commas. Throws IoError.
  CsvWriter(std::filesystem::path file, std::string_view header);
  /// The same with the names of these columns.
  CsvWriter(std::filesystem::path file, std::span<const Column> columns)
      : CsvWriter(std::move(file), header_of(columns)) {}

  /// One row: numbers, Vec3 (three cells), text (quoted if it must be), std::optional<double> (an empty cell for none),
  /// std::span of numbers or of optional ones (a cell each, perhaps none).
  /// Precondition: as many cells as the header has columns. Errors are kept for `finish`.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    cells_ = 0;
    (put(cells), ...);
    end_row();
  }

  /// Writes a row of cells whose types are known only at run time.
  void cells(std::span<const Cell> cells);

  /// Puts the table under its final name, or leaves that to a set of files. Throws IoError, also for the errors of
  /// earlier rows.
  void finish(FileSet* together = nullptr) { file_.commit(together); }

 private:
  void put(double value) noexcept;
  void put(std::uint64_t value) noexcept;
  void put(const std::optional<double>& value) noexcept;
  void put(std::string_view text) noexcept;
  template <class Values>
  requires(requires(const Values& v) { v.begin(); } &&
           !std::convertible_to<Values, std::string_view>) void put(const Values& values) noexcept {
    for (const auto& value : values) put(value);
  }
  void begin_cell() noexcept;
  void end_row() noexcept;

  AtomicFile file_;
  std::size_t columns_;
  std::size_t cells_ = 0;  ///< of the row being written
};

/// Writes a table of fields, a line for each row; `together` as in CsvWriter::finish. Throws IoError.
template <class Row, std::size_t size>
void write_csv(const std::filesystem::path& file, const Field<Row> (&fields)[size], const std::vector<Row>& rows,
               FileSet* together = nullptr) {
  CsvWriter csv(file, columns_of(fields));
  std::vector<Cell> cells;
  for (const Row& row : rows) {
    cells.clear();
    for (const Field<Row>& field : fields) {
      if (field.in != Field<Row>::In::json) cells.push_back(field.cell(row));
    }
    csv.cells(cells);
  }
  csv.finish(together);
}

}  // namespace hapbench
