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

/// Reads the table that a sweep leaves, sweep.csv.
namespace hapbench {

/// Outcome of a run that an exception ended; the cells behind `expected` are empty.
inline constexpr std::string_view kErrorOutcome = "error";

/// The cells of a line.
using SweepRow = std::vector<std::string>;

/// How runs ended.
struct SweepCounts {
  struct Count {
    std::size_t runs = 0, expected = 0;
  };
  std::map<std::string, Count> outcomes;
  std::size_t runs = 0;
  std::size_t failed = 0;      ///< runs that an exception ended
  std::size_t unexpected = 0;  ///< runs that ended otherwise than their scenario expects, failed ones not included
  std::optional<std::size_t> first_unexpected;

  void add(std::size_t run, const std::string& outcome, bool is_expected);
};

/// Columns: the run's number, the varied fields, outcome, expected, steps, every metric, the tolerances of the bounded
/// ones, state_hash.
struct SweepTable {
  static constexpr std::size_t kMostRows = 10'000;  ///< that are kept

  std::filesystem::path file;
  Json about;  ///< sweep.json
  std::vector<std::string> columns;
  std::vector<SweepRow> rows;  ///< those that keep the conditions; none when they are more than kMostRows
  SweepCounts counts;          ///< of all rows
  SweepCounts kept;            ///< of those that keep the conditions

  /// The place of a column; the number of columns where it is none.
  std::size_t place(std::string_view column) const {
    return static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
  }
  /// Number of the fields that vary.
  std::size_t fields() const { return place("outcome") - 1; }
  const std::string& outcome(const SweepRow& row) const { return row[1 + fields()]; }
  std::vector<std::string> metrics() const;
  /// Empty for a column that does not exist, and where a cell is not a number.
  std::optional<double> number(const SweepRow& row, std::string_view column) const;
  /// Error of a metric; empty if it is not known.
  std::optional<double> tolerance(const SweepRow& row, std::string_view metric) const {
    return number(row, std::string(kToleranceOf) + std::string(metric));
  }
};

/// Reads the table of a sweep or of one of its shards, and the JSON file next to it. Keeps the rows that meet all
/// `conditions`, which are the texts of --where (row_condition.hpp). Throws InputError.
SweepTable read_sweep(const std::filesystem::path& file, const std::vector<std::string>& conditions = {});

/// Returns the numbers of the runs whose rows in the table meet all `conditions`, in the table's order, however many
/// these are. Does not read the JSON file. Throws InputError.
std::vector<std::size_t> runs_that_meet(const std::filesystem::path& file, const std::vector<std::string>& conditions);

}  // namespace hapbench
