#pragma once

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include "scenarios/batch/cases.hpp"
#include "scenarios/input/largest_sizes.hpp"

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

/// The file of a sweep, sweep.csv, or of one of its shards, sweep.0_of_4.csv.
std::string table_name(const std::optional<Shard>& shard);

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

struct SweepReport {
  std::size_t resumed = 0;            ///< number of rows that were there before
  std::optional<std::size_t> failed;  ///< the lowest number of a run that an exception ended
  std::string problem;                ///< of that run
};

/// Runs the shard's part of a plan and writes its table and the JSON next to it, which depend neither on the jobs nor
/// on interruptions. Runs in one environment share its shell. A killed sweep loses the runs under way; SIGINT and
/// SIGTERM end it after those. Throws InputError where the table of another sweep would be resumed or that of this one
/// lost, IoError and Stopped.
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

/// Reads the table of a sweep or of one of its shards, and the JSON file next to it. `conditions` are texts such as
/// "inside_max_m<3e-4": a column, one of < <= > >= = !=, and a number, or with = and != a text; a row without a number
/// in a column keeps no condition on numbers. Throws InputError.
SweepTable read_sweep(const std::filesystem::path& file, const std::vector<std::string>& conditions = {});

/// Joins the tables of all shards that are in a folder into sweep.csv. False when there are none, or not all beside a
/// whole table. Throws InputError for tables that are damaged, incomplete or not of one definition, and IoError.
bool join_shards(const std::filesystem::path& folder);

// ---- The table while it grows

/// The file of a table, its columns, and the JSON next to it, whose "definition" is equal for equal tables.
struct TableTitle {
  std::filesystem::path file;
  std::string header;     ///< line without its end; the first column is the number of the case
  Json about;             ///< written beside the table as NAME.json
  std::size_t cases = 0;  ///< rows have numbers below
};

/// A table with a row for each case. It grows as FILE.part, with its JSON next to it, a row at a time and in any order,
/// so that a killed process loses only the cases that were under way. When it is whole its rows are put in order and
/// both files get their names. Memory: 8 bytes a case while they are put in order, before that a bit.
class TableFile {
 public:
  /// Whether a row that was written before stays; one that does not is written again. May throw.
  using Keep = std::function<bool(std::size_t i, std::string_view row)>;

  /// Begins a table, over another one that was under way. With `keep`, goes on with it, or with a finished one: a torn
  /// last line is dropped. Throws InputError where a table that is under way would lose its rows without `keep`, or is
  /// another one or damaged with it, and IoError.
  explicit TableFile(TableTitle title, const Keep& keep = {});

  /// Rows of a table that is under way.
  static std::size_t rows_under_way(const std::filesystem::path& file);

  /// Which cases have a row.
  const std::vector<bool>& rows() const { return has_; }
  std::size_t count() const { return static_cast<std::size_t>(std::count(has_.begin(), has_.end(), true)); }
  /// Other processes see the row when this returns. Throws IoError. Precondition: it is one line.
  void add(std::size_t i, std::string_view row);
  /// Puts the rows in order, by number; of two of one case the later stays. Throws IoError.
  void finish();

 private:
  bool is_of_this_definition() const;
  void resume(const Keep& keep);
  void append(const std::string& text);

  TableTitle title_;
  std::filesystem::path part_, about_part_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> out_;
  std::vector<bool> has_;
};

}  // namespace hapbench
