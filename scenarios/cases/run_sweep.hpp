#pragma once

#include <algorithm>
#include <map>
#include <optional>

#include "scenarios/cases/table_file.hpp"

/// Sweeps: cases that are checked first, then run, and the table that they leave, sweep.csv.
namespace hapbench {

/// Cases to run, checked before the first run.
struct SweepPlan {
  Cases cases;

  std::vector<std::string> warnings = {};  ///< of the runs that were checked, without duplicates
  std::vector<std::string> metrics = {};   ///< that some of these runs have
  std::vector<std::string> bounded = {};   ///< those of the metrics whose rows say by how much they may be wrong
  /// Everything that determines the rows: scenes, overrides, points, hashes of the files the scenarios name, program.
  Json content = {};
  std::string definition = {};  ///< FNV-1a of the content, as 16 hexadecimal digits

  /// The names of the columns of the table.
  std::vector<std::string> columns() const;
  /// The JSON file next to the table of a shard, which says what it is about.
  Json description(const Shard& shard) const;
};

/// Maximum number of runs of a sample, and of values of a field of a grid, that are checked before the first run.
inline constexpr std::size_t kMostChecked = 1000;

/// The runs that are checked, in order: all of at most kMostChecked. Of a larger grid those at its edges through the
/// first and the last run, along each of which one field takes its values (at most kMostChecked of them, the ends
/// included); of a larger sample the first.
std::vector<std::size_t> runs_to_check(const Cases& cases);

/// Loads the scenarios of the runs to check and reads the files they name, to find errors before anything is run or
/// written; some 0.1 ms a run and thread. Throws InputError, that of the run with the lowest number, and Stopped.
SweepPlan plan_sweep(Cases cases, const JobOptions& jobs);

struct SweepOptions {
  std::filesystem::path directory = {};  ///< for all files; must exist
  JobOptions jobs = {};
  std::optional<Shard> shard = {};  ///< which runs; none: all
  bool resume = false;     ///< keep the rows that an earlier sweep of this plan has, but for those of failed runs
  bool keep_runs = false;  ///< write the files of each run into runs/NUMBER
  std::function<void()> added = {};  ///< is called after each row of a finished run that the table gets

  /// sweep.csv, or that of a shard.
  std::filesystem::path table() const { return directory / table_name(shard); }
};

/// A run that an exception ended.
struct FailedRun {
  std::size_t run = 0;
  std::string problem;
};

struct SweepReport {
  std::size_t resumed = 0;          ///< number of rows that were there before
  std::optional<FailedRun> failed;  ///< the failed run with the lowest number
};

/// Runs the shard's part of a plan and writes its table and the JSON next to it, which depend neither on the jobs nor
/// on interruptions. Runs in one environment share its shell. A killed sweep loses the runs in flight (table_file.hpp);
/// SIGINT and SIGTERM end it after those. Throws InputError where the table of another sweep would be resumed or that
/// of this one lost, IoError when something cannot be written, and Stopped.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

// ---- What a sweep leaves

/// Outcome of a run that an exception ended; the cells behind `expected` are empty.
inline constexpr std::string_view kErrorOutcome = "error";

/// Stands before the name of a metric in the heading of its tolerance, as in summary.json.
inline constexpr std::string_view kToleranceOf = "tolerances.";

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

/// Reads the table of a sweep or of one of its shards, and the JSON file next to it. `conditions` are texts such as
/// "inside_max_m<3e-4": a column, one of < <= > >= = !=, and a number, or with = and != a text; a row without a number
/// in a column keeps no condition on numbers. Throws InputError.
SweepTable read_sweep(const std::filesystem::path& file, const std::vector<std::string>& conditions = {});

}  // namespace hapbench
