#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// sweep.csv: its columns and rows, and what they tell.
namespace hapbench {

/// Outcome of a run that an exception ended.
inline constexpr std::string_view kErrorOutcome = "error";

/// Stands before the name of a metric in the heading of its tolerance, as in summary.json.
inline constexpr std::string_view kToleranceOf = "tolerances.";

/// A row of sweep.csv.
struct SweepRow {
  std::size_t run = 0;
  std::vector<std::string> values;  ///< of the varied fields
  std::string outcome;              ///< kErrorOutcome: the cells behind `expected` are empty
  bool expected = false;            ///< the scenario's expectations are met
  std::string state_hash;
  std::vector<std::string> cells;  ///< all of them

  /// The value of a metric of the plan as a number; none when the run has none. Precondition: the plan has the metric.
  std::optional<double> number(const SweepPlan& plan, std::string_view metric) const;
  /// By how much that metric may be wrong; none where that is not known.
  std::optional<double> tolerance(const SweepPlan& plan, std::string_view metric) const;
};

/// The names of the columns: run number, the varied fields, outcome, expected, steps, every metric, the tolerances of
/// the bounded ones, state_hash.
std::vector<std::string> sweep_columns(const SweepPlan& plan);
/// The line of a finished run, without its end. Throws InputError if the run has a metric for which there is no column.
std::string finished_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary);
/// The line of a run that an exception ended.
std::string error_row(const SweepPlan& plan, std::size_t run);
/// The row in a line. Throws InputError when it has more or fewer cells than there are columns.
SweepRow sweep_row(const SweepPlan& plan, std::string_view line);
/// The row as an object with the columns' names: numbers and booleans as such, null for empty cells. The values of
/// varied fields are typed by their text, as those of --set are.
Json row_json(const SweepPlan& plan, const SweepRow& row);

/// How the runs of a sweep ended.
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

  void add(const SweepRow& row);
};

/// A run that an exception ended.
struct FailedRun {
  std::size_t run = 0;
  std::string problem;
};

/// Result of a sweep.
struct SweepReport {
  /// Maximum number of rows in a report.
  static constexpr std::size_t kMostRows = 10'000;

  std::size_t done = 0;             ///< number of the shard's runs that have a row
  SweepCounts counts;               ///< of the table
  std::vector<SweepRow> rows;       ///< of the table, by run number; empty if there are more than kMostRows
  std::optional<FailedRun> failed;  ///< the failed run with the lowest number
  std::size_t resumed = 0;          ///< number of rows that were there before
  int signal = 0;                   ///< the signal that stopped the sweep before there was a table, or 0
  std::filesystem::path table;      ///< sweep.csv, or sweep.I_of_N.csv
};

/// A finished sweep, read back from its folder.
struct SweepOnRecord {
  SweepPlan plan;      ///< its cases, without scenes, its metrics and definition
  SweepReport report;  ///< of the rows that keep the conditions
};

/// Reads sweep.csv and sweep.json. `conditions` are texts such as "inside_max_m<3e-4": a column, one of < <= > >= = !=,
/// and a number, or with = and != a text; a row without a number in a column keeps no condition on numbers. Throws
/// InputError.
SweepOnRecord read_sweep(const std::filesystem::path& folder, const std::vector<std::string>& conditions);

}  // namespace hapbench
