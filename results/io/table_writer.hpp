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

/// A range whose elements are cells of a row. A text does not satisfy the concept, because a text is a single cell.
template <class Values>
concept CellRange = requires(const Values& values) {
  values.begin();
}
&&!std::convertible_to<Values, std::string_view>;

/// Writes a comma-separated table with a header line, row by row, into an AtomicFile. Format: RFC 4180 with "\n" as
/// line break; numbers as in NumberText. Rows of numbers allocate nothing after the constructor. Writing a number takes
/// about 30 ns.
class CsvWriter {
 public:
  /// `header`: first line, column names separated by commas. Throws IoError.
  CsvWriter(std::filesystem::path file, std::string_view header)
      : file_(std::move(file)), columns_(static_cast<std::size_t>(std::ranges::count(header, ',')) + 1) {
    constexpr std::size_t kLongestNumber = 25;  // including its comma
    row_.reserve(columns_ * kLongestNumber + 1);
    file_.append(header);
    file_.append("\n");
  }

  /// Writes one row. Arguments: a number, a Vec3 (three cells), a text (quoted if necessary), a
  /// std::optional<double> (an empty cell if it has no value), or a std::span of numbers or optionals (one cell for
  /// each entry; the span may be empty). Precondition: as many cells as the header has columns. `finish` throws the
  /// first error.
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

  /// Completes the file and gives it its final name. If `together` is not null, FileSet::commit of this set completes
  /// and renames the file later. Throws IoError, also if an earlier row could not be written.
  void finish(FileSet* together = nullptr) { file_.commit(together); }

 private:
  void put(double value) noexcept { cell() += NumberText(value); }
  void put(std::unsigned_integral auto value) noexcept { cell() += NumberText(std::uint64_t{value}); }
  void put(const std::optional<double>& value) noexcept { value ? put(*value) : static_cast<void>(cell()); }
  void put(std::string_view text) noexcept { cell() += csv_cell(text); }
  void put(const CellRange auto& values) noexcept {
    for (const auto& value : values) put(value);
  }
  /// Begins the next cell of the row and returns the string to which its text is appended.
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
  std::size_t cells_ = 0;  ///< number of cells in the current row so far
  std::string row_;        ///< text of the current row so far
};

/// A table of numbers in memory, with the same rows as the CSV file; an empty cell is NaN. The table allocates memory
/// pages with mmap and not on the heap, so recording a step makes no heap allocation.
class MemoryTable {
 public:
  explicit MemoryTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
  ~MemoryTable();
  MemoryTable(const MemoryTable&) = delete;
  MemoryTable& operator=(const MemoryTable&) = delete;

  /// Adds a row like CsvWriter::row, but without text. If memory is exhausted, the row is lost and require_complete
  /// throws.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    if (!reserve(columns_.size())) return;
    (put(cells), ...);
  }

  /// Throws std::bad_alloc if a row was lost.
  void require_complete() const {
    if (!complete_) throw std::bad_alloc();
  }

  const std::vector<Column>& columns() const { return columns_; }
  std::size_t rows() const { return size_ / columns_.size(); }
  /// All numbers, row by row.
  std::span<const double> numbers() const { return {data_, size_}; }

 private:
  /// Makes room for `more` numbers. Returns false if memory is exhausted.
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
  std::size_t size_ = 0;      ///< count of numbers in the table
  std::size_t capacity_ = 0;  ///< count of numbers that fit into the allocated memory pages
  bool complete_ = true;      ///< true if no row was lost
};

/// Destination of a table of numbers: the path of a CSV file, or a table in memory. The pointer is never null, and the
/// table outlives the writer.
using TableTarget = std::variant<std::filesystem::path, MemoryTable*>;

/// Writes a table of numbers, row by row. Allocates only in the constructor.
class TableWriter {
 public:
  /// Precondition: if `target` is a table in memory, its columns are `columns`. Throws IoError.
  TableWriter(const TableTarget& target, std::span<const Column> columns) {
    if (const auto* file = std::get_if<std::filesystem::path>(&target))
      csv_.emplace(*file, header_of(columns));
    else
      memory_ = std::get<MemoryTable*>(target);
  }

  /// Writes one row like CsvWriter::row; numeric cells only.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    memory_ != nullptr ? memory_->row(cells...) : csv_->row(cells...);
  }

  /// Like CsvWriter::finish. Throws IoError, or std::bad_alloc if a row was lost in memory.
  void finish(FileSet* together = nullptr) {
    memory_ != nullptr ? memory_->require_complete() : csv_->finish(together);
  }

 private:
  std::optional<CsvWriter> csv_;
  MemoryTable* memory_ = nullptr;
};

}  // namespace hapbench
