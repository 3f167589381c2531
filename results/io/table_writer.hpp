#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "results/io/csv_writer.hpp"
#include "results/io/memory_table.hpp"

namespace hapbench {

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
