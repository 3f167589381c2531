#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// A comma-separated table with a header line, written by rows into an AtomicFile (RFC 4180, lines end in "\n"), with
/// numbers as in NumberText. Allocates in the constructor only; about 30 ns a number.
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
    (put(cells), ...);
    end_row();
  }

  /// Writes a row of cells whose types are known only at run time.
  void cells(std::span<const Cell> cells);

  /// Puts the table under its final name, or leaves that to a set of files. Throws IoError, also for earlier rows.
  void finish(FileSet* together = nullptr) { file_.commit(together); }

 private:
  void put(double value) noexcept { cell() += NumberText(value); }
  void put(std::uint64_t value) noexcept { cell() += NumberText(value); }
  void put(const std::optional<double>& value) noexcept { value ? put(*value) : static_cast<void>(cell()); }
  void put(std::string_view text) noexcept { cell() += csv_cell(text); }
  template <class Values>
  requires(requires(const Values& v) { v.begin(); } &&
           !std::convertible_to<Values, std::string_view>) void put(const Values& values) noexcept {
    for (const auto& value : values) put(value);
  }
  /// Begins the next cell of the row; what is added to it is the cell.
  std::string& cell() noexcept { return cells_++ > 0 ? row_ += ',' : row_; }
  void end_row() noexcept;

  AtomicFile file_;
  std::size_t columns_;
  std::size_t cells_ = 0;  ///< of the row being written
  std::string row_;        ///< so far
};

/// A table of numbers in memory with the same rows as the CSV file; an empty cell is NaN. It grows by memory pages of
/// its own and not on the heap, so that a recorded step allocates nothing.
class MemoryTable {
 public:
  /// `columns` must outlive the table.
  explicit MemoryTable(std::span<const Column> columns) : columns_(columns) {}
  ~MemoryTable();
  MemoryTable(const MemoryTable&) = delete;
  MemoryTable& operator=(const MemoryTable&) = delete;

  /// Adds a row of cells as CsvWriter::row, without text. Without memory it is lost, and require_complete throws.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    if (!reserve(columns_.size())) return;
    (put(cells), ...);
  }

  /// Throws std::bad_alloc when a row was lost.
  void require_complete() const {
    if (!complete_) throw std::bad_alloc();
  }

  std::span<const Column> columns() const { return columns_; }
  std::size_t rows() const { return size_ / columns_.size(); }
  /// Row after row.
  std::span<const double> numbers() const { return {data_, size_}; }

 private:
  bool reserve(std::size_t more) noexcept;
  void put(double value) noexcept { data_[size_++] = value; }
  void put(std::uint64_t value) noexcept { put(static_cast<double>(value)); }
  void put(const std::optional<double>& value) noexcept {
    put(value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  template <class Values>
  requires(requires(const Values& v) { v.begin(); } &&
           !std::convertible_to<Values, std::string_view>) void put(const Values& values) noexcept {
    for (const auto& value : values) put(value);
  }

  std::span<const Column> columns_;
  double* data_ = nullptr;
  std::size_t size_ = 0;      ///< numbers
  std::size_t capacity_ = 0;  ///< numbers
  bool complete_ = true;
};

/// The destination of a table of numbers: a CSV file, or memory (never null, outlives the writer).
using TableTarget = std::variant<std::filesystem::path, MemoryTable*>;

/// Writes a table of numbers row by row. Allocates in the constructor only.
class TableWriter {
 public:
  /// A table in memory has the same `columns`. Throws IoError.
  TableWriter(TableTarget target, std::span<const Column> columns) {
    if (auto* file = std::get_if<std::filesystem::path>(&target)) {
      csv_.emplace(std::move(*file), columns);
    } else {
      memory_ = std::get<MemoryTable*>(target);
    }
  }

  /// As CsvWriter::row, for numeric cells only.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    if (memory_ != nullptr) {
      memory_->row(cells...);
    } else {
      csv_->row(cells...);
    }
  }

  /// As CsvWriter::finish. Throws IoError or, for a row that memory has lost, std::bad_alloc.
  void finish(FileSet* together = nullptr) {
    if (memory_ != nullptr) {
      memory_->require_complete();
    } else {
      csv_->finish(together);
    }
  }

 private:
  std::optional<CsvWriter> csv_;
  MemoryTable* memory_ = nullptr;
};

}  // namespace hapbench
