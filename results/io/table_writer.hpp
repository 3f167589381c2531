#pragma once

#include <algorithm>
#include <cassert>
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

namespace hapbench {

/// Several cells of a row.
template <class Values>
concept CellRange = requires(const Values& values) {
  values.begin();
}
&&!std::convertible_to<Values, std::string_view>;

/// A comma-separated table with a header line, written by rows into an AtomicFile (RFC 4180, lines end in "\n"), with
/// numbers as in NumberText. Allocates in the constructor only; about 30 ns a number.
class CsvWriter {
 public:
  /// `header` is the first line, column names separated by commas. Throws IoError.
  CsvWriter(std::filesystem::path file, std::string_view header)
      : file_(std::move(file)), columns_(static_cast<std::size_t>(std::ranges::count(header, ',')) + 1) {
    constexpr std::size_t kLongestNumber = 25;  // with its comma
    row_.reserve(columns_ * kLongestNumber + 1);
    file_.append(header);
    file_.append("\n");
  }

  /// One row: numbers, Vec3 (three cells), text (quoted if it must be), std::optional<double> (an empty cell for none),
  /// std::span of numbers or of optional ones (a cell each, perhaps none).
  /// Precondition: as many cells as the header has columns. Errors are kept for `finish`.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    (put(cells), ...);
    end_row();
  }

  /// Writes a row of cells whose types are known only at run time.
  void cells(std::span<const Cell> cells) {
    for (const Cell& held : cells) put(std::string_view(cell_text(held)));
    end_row();
  }

  /// Puts the table under its final name, or leaves that to a set of files. Throws IoError, also for earlier rows.
  void finish(FileSet* together = nullptr) { file_.commit(together); }

 private:
  void put(double value) noexcept { cell() += NumberText(value); }
  void put(std::unsigned_integral auto value) noexcept { cell() += NumberText(std::uint64_t{value}); }
  void put(const std::optional<double>& value) noexcept { value ? put(*value) : static_cast<void>(cell()); }
  void put(std::string_view text) noexcept { cell() += csv_cell(text); }
  void put(const CellRange auto& values) noexcept {
    for (const auto& value : values) put(value);
  }
  /// Begins the next cell of the row; what is added to it is the cell.
  std::string& cell() noexcept { return cells_++ > 0 ? row_ += ',' : row_; }
  void end_row() noexcept {
    assert(cells_ == columns_);
    cells_ = 0;
    row_ += '\n';
    file_.append(row_);
    row_.clear();
  }

  AtomicFile file_;
  std::size_t columns_;
  std::size_t cells_ = 0;  ///< of the row being written
  std::string row_;        ///< so far
};

/// A table of numbers in memory with the same rows as the CSV file; an empty cell is NaN. It grows by memory pages of
/// its own and not on the heap, so that a recorded step allocates nothing.
class MemoryTable {
 public:
  explicit MemoryTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
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

  const std::vector<Column>& columns() const { return columns_; }
  std::size_t rows() const { return size_ / columns_.size(); }
  /// Row after row.
  std::span<const double> numbers() const { return {data_, size_}; }

 private:
  bool reserve(std::size_t more) noexcept;
  void put(double value) noexcept { data_[size_++] = value; }
  void put(std::unsigned_integral auto value) noexcept { put(static_cast<double>(value)); }
  void put(const std::optional<double>& value) noexcept {
    put(value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  void put(const CellRange auto& values) noexcept {
    for (const auto& value : values) put(value);
  }

  std::vector<Column> columns_;
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
  TableWriter(const TableTarget& target, std::span<const Column> columns) {
    if (const auto* file = std::get_if<std::filesystem::path>(&target))
      csv_.emplace(*file, header_of(columns));
    else
      memory_ = std::get<MemoryTable*>(target);
  }

  /// As CsvWriter::row, for numeric cells only.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    memory_ != nullptr ? memory_->row(cells...) : csv_->row(cells...);
  }

  /// As CsvWriter::finish. Throws IoError or, for a row that memory has lost, std::bad_alloc.
  void finish(FileSet* together = nullptr) {
    memory_ != nullptr ? memory_->require_complete() : csv_->finish(together);
  }

 private:
  std::optional<CsvWriter> csv_;
  MemoryTable* memory_ = nullptr;
};

}  // namespace hapbench
