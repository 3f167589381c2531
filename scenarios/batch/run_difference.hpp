#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hapbench {

/// The difference of a number or text in two results.
struct CellDifference {
  std::string a, b;       ///< as written; empty if missing
  double largest = 0.0;   ///< |a - b|; infinite when not both are numbers
  double relative = 0.0;  ///< |a - b| / max(|a|, |b|); infinite likewise
};

/// Precondition: the cells differ. Numbers that are equal though written differently (0 and -0) differ by 0.
CellDifference cell_difference(std::string a, std::string b);

/// The largest difference of a column of two tables.
struct ColumnDifference {
  std::string column;
  double largest = 0.0;   ///< infinite when somewhere not both are numbers
  std::size_t row = 0;    ///< the first row where it occurs, from 0
  double relative = 0.0;  ///< largest / the column's largest magnitude in either table
};

/// The first cell in which two tables differ.
struct FirstDifference {
  std::size_t row = 0;  ///< from 0
  std::string column;
  std::string a, b;
};

/// The differences of two tables of results, in their common rows and columns.
struct TableDifference {
  std::size_t rows_a = 0, rows_b = 0;
  std::vector<std::string> only_in_a, only_in_b;  ///< columns
  bool reordered = false;                         ///< the common columns come in another order
  std::optional<FirstDifference> first;
  std::vector<ColumnDifference> columns;  ///< that differ, in order

  /// Returns true if rows or columns are missing, columns are in another order or one differs by more than the
  /// tolerance relative to its largest magnitude. State hashes, which change with any bit, count only with a tolerance
  /// of 0.
  bool is_beyond(double tolerance) const;
};

/// Reads both files, comma-separated with a header. Throws InputError that names file and line.
TableDifference compare_tables(const std::filesystem::path& a, const std::filesystem::path& b);

/// A value that is different in two JSON files.
struct NamedDifference {
  std::string name;  ///< dotted path, as in --set
  CellDifference values;
};

/// The differences between the results of two runs.
struct RunDifference {
  std::vector<NamedDifference> fields;   ///< of scenario.effective.json; named files are compared by their contents
  std::vector<NamedDifference> metrics;  ///< outcome, steps and numbers of summary.json
  /// Metrics and warnings in only one summary: "< name" in the first, "> name" in the second; "< warning: text".
  std::vector<std::string> unshared;
  std::string state_hash_a, state_hash_b;
  std::optional<TableDifference> trajectory;  ///< if both runs recorded one
  bool trajectory_missing = false;            ///< only one run recorded one

  /// Returns true if the results differ by more than the tolerance: the outcome, a metric relative to the larger value,
  /// the trajectory, or, with a tolerance of 0, the state hash; or if a metric, a warning or the trajectory is in only
  /// one of them. Fields of the scenario do not count.
  bool is_beyond(double tolerance) const;
};

/// Compares the folders of two runs, except for provenance, times and counted work. Throws InputError when a file
/// cannot be used.
RunDifference compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace hapbench
