#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/sweep_columns.hpp"

/// Reads the table of a sweep, sweep.csv.
namespace hapbench {

/// Outcome of a run that ended with an exception. Its cells after `expected` are empty.
inline constexpr std::string_view kErrorOutcome = "error";

/// The cells of a row of sweep.csv.
using SweepRow = std::vector<std::string>;

/// Counts how runs ended.
struct SweepCounts {
  struct Count {
    std::size_t runs = 0, expected = 0;
  };
  std::map<std::string, Count> outcomes;
  std::size_t runs = 0;
  std::size_t failed = 0;  ///< runs that ended with an exception
  /// For each outcome, the numbers of the runs whose scenario does not expect this outcome, in the order of the table.
  /// Runs that ended with an exception are not included.
  std::map<std::string, std::vector<std::size_t>> unexpected;

  void add(std::size_t run, const std::string& outcome, bool is_expected);
};

/// The table of a sweep. Columns: number of the run, varied fields, outcome, expected, steps, ended_at_s, all metrics,
/// tolerances of metrics with an error bound, state_hash.
struct SweepTable {
  static constexpr std::size_t kMaxRows = 10'000;  ///< maximum number of rows that are kept in memory

  std::filesystem::path file;
  Json about;  ///< content of sweep.json
  std::vector<std::string> columns;
  /// Rows that satisfy the conditions of read_sweep(); empty if more than kMaxRows rows satisfy the conditions.
  std::vector<SweepRow> rows;
  SweepCounts counts;   ///< counts of all rows
  SweepCounts kept;     ///< counts of the rows that satisfy the conditions
  std::string warning;  ///< what is missing in the table; empty if all rows are there

  /// Returns the index of a column; the number of columns if it does not exist.
  std::size_t column_index(std::string_view column) const {
    return static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
  }
  /// Returns the number of fields that vary.
  std::size_t fields() const { return column_index("outcome") - 1; }
  const std::string& outcome(const SweepRow& row) const { return row[1 + fields()]; }
  /// Returns the names of the metric columns.
  std::vector<std::string> metrics() const;
  /// Returns the number in a column of a row. Returns nothing if the column does not exist or the cell is not a number.
  std::optional<double> number(const SweepRow& row, std::string_view column) const;
  /// Returns the error (tolerance) of a metric in a row; empty if it is not known.
  std::optional<double> tolerance(const SweepRow& row, std::string_view metric) const {
    return number(row, std::string(kToleranceOf) + std::string(metric));
  }
};

/// Reads the table of a sweep or of one of its shards, and the JSON file next to it. Keeps the rows that satisfy all
/// `conditions`, which are the texts of --where (row_condition.hpp). Throws InputError, also for a cell or a line that
/// a sweep does not write.
SweepTable read_sweep(const std::filesystem::path& file, const std::vector<std::string>& conditions = {});

/// Returns the names of the varied fields without effect: rows that have the same values of all other fields, and at
/// least two such rows exist, are equal to the last bit. Considers the rows of `table.rows` without exceptions.
std::vector<std::string> fields_without_effect(const SweepTable& table);

/// Returns the numbers of the runs whose rows in the table meet all `conditions`, in the table's order, also if there
/// are more than SweepTable::kMaxRows. Does not read the JSON file. Throws InputError.
std::vector<std::size_t> runs_that_meet(const std::filesystem::path& file, const std::vector<std::string>& conditions);

}  // namespace hapbench
