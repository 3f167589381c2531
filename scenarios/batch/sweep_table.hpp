#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/axis.hpp"

/// The table of a sweep, sweep.csv, as it is read from its folder.
namespace hapbench {

/// Outcome of a run that an exception ended; the cells behind `expected` are empty.
inline constexpr std::string_view kErrorOutcome = "error";

/// Stands before the name of a metric in the heading of its tolerance, as in summary.json.
inline constexpr std::string_view kToleranceOf = "tolerances.";

/// The first columns of the table: the run's number, the fields, outcome, expected and steps.
std::vector<std::string> leading_columns(const std::vector<Axis>& axes);

/// The cells of a line.
using SweepRow = std::vector<std::string>;

/// How runs ended.
struct SweepCounts {
  struct Count {
    std::size_t runs = 0;
    std::size_t expected = 0;
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
  /// Maximum number of rows that are kept.
  static constexpr std::size_t kMostRows = 10'000;

  std::filesystem::path file;
  std::string definition;  ///< of the plan
  std::vector<Axis> axes;  ///< the fields that vary; without their values for the points of a file
  bool sampled = false;    ///< no grid
  std::size_t cases = 0;   ///< of the whole sweep
  std::vector<std::string> columns;
  std::vector<SweepRow> rows;  ///< those that keep the conditions; none when they are more than kMostRows
  SweepCounts counts;          ///< of all rows
  SweepCounts kept;            ///< of those that keep the conditions

  /// The place of `outcome`.
  std::size_t outcome_place() const { return 1 + axes.size(); }
  const std::string& outcome(const SweepRow& row) const { return row[outcome_place()]; }
  std::vector<std::string> metrics() const;
  /// None for a column that there is not, and where a cell is no number.
  std::optional<double> number(const SweepRow& row, std::string_view column) const;
  /// By how much a metric may be wrong; none where that is not known.
  std::optional<double> tolerance(const SweepRow& row, std::string_view metric) const;
};

/// Reads the table of a sweep or of one of its shards, and the JSON file beside it. `conditions` are texts such as
/// "inside_max_m<3e-4": a column, one of < <= > >= = !=, and a number, or with = and != a text; a row without a number
/// in a column keeps no condition on numbers. Throws InputError.
SweepTable read_sweep(const std::filesystem::path& file, const std::vector<std::string>& conditions = {});

}  // namespace hapbench
