#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hapbench {

/// How two numbers or texts of two results differ.
struct CellDifference {
  std::string a, b;       ///< as written; empty for none
  double largest = 0.0;   ///< |a - b|; infinite when not both are numbers
  double relative = 0.0;  ///< |a - b| / max(|a|, |b|); infinite likewise
};

/// Precondition: the cells differ. Numbers that are equal though written differently (0 and -0) differ by 0.
CellDifference cell_difference(std::string a, std::string b);

/// The largest difference of a column of two tables.
struct ColumnDifference {
  std::string column;
  double largest = 0.0;   ///< infinite when somewhere not both are numbers
  std::size_t row = 0;    ///< where, from 0: the first such row
  double relative = 0.0;  ///< largest / the column's largest magnitude in either table
};

/// The first cell in which two tables differ.
struct FirstDifference {
  std::size_t row = 0;  ///< from 0
  std::string column;
  std::string a, b;
};

/// How two tables of results differ, row by row as far as both have rows, in the columns they share.
struct TableDifference {
  std::size_t rows_a = 0, rows_b = 0;
  std::vector<std::string> only_in_a, only_in_b;  ///< columns
  std::optional<FirstDifference> first;
  std::vector<ColumnDifference> columns;  ///< those that differ, in order

  /// Rows are missing, or a column differs by more than the tolerance relative to its largest magnitude; state hashes,
  /// which differ for any difference, count with a tolerance of 0.
  bool is_beyond(double tolerance) const;
};

/// Reads both files, comma-separated with a header. Throws InputError that names file and line.
TableDifference compare_tables(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace hapbench
