#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// sweep.csv: its rows, the tables of shards, and how shards are merged. The table of a shard is that of a sweep after
/// a title line that says which sweep it belongs to. No cell needs quotes.
namespace hapbench {

/// A part of a sweep: the runs whose number leaves the remainder `index` when divided by `count`. By default all.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  bool has(std::size_t run) const { return run % count == index; }
  /// Number of the sweep's runs that belong to this shard.
  std::size_t size(std::size_t runs) const { return (runs + count - 1 - index) / count; }
};

/// Reads "i/n" with 0 <= i < n. Throws InputError.
Shard parse_shard(const std::string& text);

/// "i/n"
std::string shard_text(const Shard& shard);

/// Outcome of a run that an exception ended.
inline constexpr std::string_view kErrorOutcome = "error";

/// A row of sweep.csv.
struct SweepRow {
  std::size_t run = 0;
  std::string outcome;                    ///< kErrorOutcome: the row has no steps, metrics and state hash
  bool expected = false;                  ///< the scenario's expectations are met
  std::optional<std::size_t> steps;       ///< steps that were simulated
  std::vector<Metric::Value> metrics;     ///< one for each of the plan's metrics
  std::vector<Metric::Value> tolerances;  ///< of each of the plan's bounded metrics
  std::string state_hash;

  /// The value of a metric of the plan as a number; none when the run has none. Precondition: the plan has the metric.
  std::optional<double> number(const SweepPlan& plan, std::string_view metric) const;
  /// By how much that metric may be wrong; none where that is not known.
  std::optional<double> tolerance(const SweepPlan& plan, std::string_view metric) const;
};

/// The row of a finished run. Throws InputError if the run has a metric for which there is no column.
SweepRow sweep_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary);
/// The row of a run that an exception ended.
SweepRow error_row(const SweepPlan& plan, std::size_t run);

/// Stands before the name of a metric in the heading of its tolerance, as in summary.json.
inline constexpr std::string_view kToleranceOf = "tolerances.";

/// Column names: run number, the varied fields, outcome, expected, steps, every metric, the tolerances, state_hash.
std::string sweep_header(const SweepPlan& plan);
/// The row as a line without its end.
std::string row_text(const SweepPlan& plan, const SweepRow& row);
/// The row that row_text() wrote; none when the text is not a row of this sweep.
std::optional<SweepRow> parse_row(const SweepPlan& plan, std::string_view text);
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

/// The title and header of a shard's table.
struct ShardTitle {
  std::filesystem::path file;
  Shard shard;
  std::size_t runs = 0;    ///< of the whole sweep
  std::string definition;  ///< of the sweep
  std::string header;      ///< line without its end
};

/// The first line of a shard's table.
std::string title_line(const Shard& shard, std::size_t runs, std::string_view definition);

/// Reads the table of a shard row by row, in pieces. Its memory does not depend on the size of the table, and the file
/// is open only while a piece is read, so that there may be more shards than a process may have open files.
class ShardRows {
 public:
  /// Reads title and header. `piece` is how much is read at a time [bytes]; lines may be longer. Throws InputError that
  /// names file and line.
  explicit ShardRows(std::filesystem::path file, std::size_t piece = std::size_t{1} << 16);

  const ShardTitle& title() const { return title_; }
  /// The next row, valid until the next call; none after the last one of the shard. Throws InputError that names file
  /// and line for a row that is not the next of the shard, has more or fewer cells than the header, or is missing.
  std::optional<std::string_view> next();

 private:
  /// The next line without its end; none at the end of the file.
  std::optional<std::string_view> line();
  bool read_piece();
  void read_title(std::string_view line);

  ShardTitle title_;
  std::size_t piece_;
  std::string text_;           ///< the part of the file that was read last
  std::size_t given_ = 0;      ///< length of the text that was returned
  std::uintmax_t offset_ = 0;  ///< of the end of the text in the file
  std::size_t lines_ = 0;      ///< number of lines returned
  std::size_t columns_ = 0;
  std::size_t run_ = 0;  ///< of the next row
};

/// Adds the table of a sweep, or of a shard if one is given, to the files. `row` is called for the shard's runs in
/// order. Throws IoError.
void write_sweep_table(const std::filesystem::path& file, const SweepPlan& plan, const std::optional<Shard>& shard,
                       const std::function<std::string(std::size_t run)>& row, FileSet& files);

/// The JSON file beside a table, which says what the table is about.
Json sweep_description(const SweepPlan& plan, const Shard& shard);

/// Throws InputError unless the tables are those of all shards of one sweep, each once. Precondition: there is at least
/// one.
void check_complete(std::span<const ShardTitle> shards);

/// Merges the tables of all shards of a sweep. Writes what the sweep without shards writes: the table and, if that of a
/// shard has one beside it, its description. Throws InputError for tables that are damaged, incomplete or not of one
/// sweep, and IoError. Returns the number of rows.
std::size_t merge_shard_tables(const std::filesystem::path& file, std::span<const std::filesystem::path> shards);

}  // namespace hapbench
