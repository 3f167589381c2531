#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "results/io/columns.hpp"
#include "results/io/csv_writer.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// A table of numbers in memory, row after row, with the values that the same rows have in a CSV file: an empty cell is
/// NaN. Grows by pages of its own instead of the heap, so that a step that is recorded allocates nothing.
class MemoryTable {
 public:
  /// `columns` must outlive the table.
  explicit MemoryTable(std::span<const Column> columns) : columns_(columns) {}
  ~MemoryTable();
  MemoryTable(const MemoryTable&) = delete;
  MemoryTable& operator=(const MemoryTable&) = delete;

  /// One row, of cells as CsvWriter::row takes them, but no text. Without memory for it, the row is lost, which
  /// `require_complete` tells.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    if (!reserve(columns_.size())) return;
    (put(cells), ...);
  }

  /// Throws std::bad_alloc when a row was lost.
  void require_complete() const;

  std::span<const Column> columns() const { return columns_; }
  std::size_t rows() const { return size_ / columns_.size(); }
  /// Row after row.
  std::span<const double> numbers() const { return {data_, size_}; }

 private:
  bool reserve(std::size_t more) noexcept;
  void put(double value) noexcept { data_[size_++] = value; }
  void put(std::uint64_t value) noexcept { put(static_cast<double>(value)); }
  void put(const Vec3& value) noexcept;
  void put(std::span<const double> values) noexcept;
  void put(std::span<const std::optional<double>> values) noexcept;
  void put(const std::optional<double>& value) noexcept;

  std::span<const Column> columns_;
  double* data_ = nullptr;
  std::size_t size_ = 0;      ///< numbers
  std::size_t capacity_ = 0;  ///< numbers
  bool complete_ = true;
};

/// Where a table of numbers goes: a CSV file, or memory (never null, outlives the writer).
using TableTarget = std::variant<std::filesystem::path, MemoryTable*>;

/// Writes a table of numbers row by row to its target. Allocates in the constructor only.
class TableWriter {
 public:
  /// `columns` are those of a table in memory, too. Throws IoError.
  TableWriter(TableTarget target, std::span<const Column> columns) {
    if (auto* file = std::get_if<std::filesystem::path>(&target)) {
      csv_.emplace(std::move(*file), columns);
    } else {
      memory_ = std::get<MemoryTable*>(target);
    }
  }

  /// As CsvWriter::row, of cells that are no text.
  template <class... Cells>
  void row(const Cells&... cells) noexcept {
    if (memory_ != nullptr) {
      memory_->row(cells...);
    } else {
      csv_->row(cells...);
    }
  }

  /// Puts a file under its final name. Throws IoError, also for the errors of earlier rows, or std::bad_alloc.
  void finish() {
    if (memory_ != nullptr) {
      memory_->require_complete();
    } else {
      csv_->finish();
    }
  }

 private:
  std::optional<CsvWriter> csv_;
  MemoryTable* memory_ = nullptr;
};

}  // namespace hapbench
