#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/cases/cases.hpp"

/// Sweeps: cases that are checked first, then run, and the table that they leave, sweep.csv.
namespace hapbench {

/// Cases to run, checked before the first run.
struct SweepPlan {
  Cases cases;

  std::vector<std::string> warnings;  ///< of the runs that were checked, without duplicates
  std::vector<std::string> metrics;   ///< that some of these runs have
  std::vector<std::string> bounded;   ///< those of the metrics whose rows say by how much they may be wrong
  /// Everything that determines the rows: scenes, overrides, points, hashes of the files the scenarios name, program.
  Json content;
  std::string definition;  ///< FNV-1a of the content, as 16 hexadecimal digits

  /// The names of the columns of the table.
  std::vector<std::string> columns() const;
  /// The JSON file beside the table of a shard, which says what it is about.
  Json description(const Shard& shard) const;
};

/// Maximum number of runs of a sample, and of values of a field of a grid, that are checked before the first run.
inline constexpr std::size_t kMostChecked = 1000;

/// The runs that are checked, in order: all of at most kMostChecked. Of a larger grid those at its edges through the
/// first and the last run, along each of which one field takes its values (at most kMostChecked of them, the ends
/// included); of a larger sample the first.
std::vector<std::size_t> runs_to_check(const Cases& cases);

/// Loads the scenarios of the runs to check and reads the files they name, to find errors before anything is run or
/// written; some 0.1 ms a run on each of `jobs` threads. Throws InputError, that of the run with the lowest number.
SweepPlan plan_sweep(Cases cases, std::size_t jobs, bool progress);

struct SweepOptions {
  std::filesystem::path directory;  ///< for all files; must exist
  std::size_t jobs = 1;             ///< runs at once
  std::optional<Shard> shard;       ///< which runs; none: all
  bool resume = false;     ///< keep the rows that an earlier sweep of this plan has, but for those of failed runs
  bool keep_runs = false;  ///< write the files of each run into runs/NUMBER
  bool progress = false;   ///< allow a progress bar
  std::function<void()> added = {};  ///< is called after each row of a finished run that the table gets

  Shard part() const { return shard.value_or(Shard{}); }
};

/// The table of a sweep or of one of its shards in a folder: sweep.csv, or sweep.0_of_4.csv.
std::filesystem::path table_of(const SweepOptions& options);

/// A run that an exception ended.
struct FailedRun {
  std::size_t run = 0;
  std::string problem;
};

/// The result of a sweep: how many of its runs have a row, and why others have none.
struct SweepReport {
  std::size_t done = 0;             ///< number of the shard's runs that have a row
  std::size_t resumed = 0;          ///< number of rows that were there before
  std::optional<FailedRun> failed;  ///< the failed run with the lowest number
  int signal = 0;                   ///< the signal that stopped the sweep before there was a table, or 0
};

/// Runs the shard's part of a plan and writes its table and the JSON beside it, which depend neither on `jobs` nor on
/// interruptions. Runs in one environment share its shell. A killed sweep loses the runs in flight (table_file.hpp);
/// SIGINT and SIGTERM end it after those. Throws InputError when with `resume` there is the table of another sweep, and
/// IoError when something cannot be written.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

// ---- What a sweep leaves

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
