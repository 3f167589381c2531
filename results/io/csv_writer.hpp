#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

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
  /// The same with the names of the columns.
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

  /// Puts the table under its final name. Throws IoError, also for the errors of earlier rows.
  void finish() { file_.commit(); }

 private:
  void put(double value) noexcept;
  void put(std::uint64_t value) noexcept;
  void put(const Vec3& value) noexcept;
  void put(std::span<const double> values) noexcept;
  void put(const std::optional<double>& value) noexcept;
  void put(std::span<const std::optional<double>> values) noexcept;
  void put(std::string_view text) noexcept;
  void begin_cell() noexcept;
  void end_row() noexcept;

  AtomicFile file_;
  std::size_t columns_;
  std::size_t cells_ = 0;  ///< of the row being written
};

}  // namespace hapbench
