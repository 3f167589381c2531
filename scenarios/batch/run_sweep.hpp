#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/sweep_plan.hpp"
#include "scenarios/batch/sweep_table.hpp"

namespace hapbench {

/// The runs of a shard in the order in which they are done: runs in one environment follow each other, so that few
/// shells are needed at a time; apart from that they are in order. Computed as they are asked for, but for a sample
/// with listed fields of the environment, which is sorted (8 bytes a run).
class RunOrder {
 public:
  /// Keeps a reference to the points.
  RunOrder(const SweepPoints& points, const Shard& shard);
  /// The next run; none after the last.
  std::optional<std::size_t> next();

 private:
  const SweepPoints& points_;
  Shard shard_;
  std::vector<std::size_t> axes_;    ///< those of the environment first
  std::vector<std::size_t> sorted_;  ///< all runs of such a sample
  std::size_t count_ = 0;
};

struct SweepOptions {
  std::filesystem::path directory;  ///< for all files; must exist
  std::size_t jobs = 1;             ///< runs at once
  std::optional<Shard> shard;       ///< which runs; none: all, in a table that needs no merging
  bool resume = false;              ///< take the rows of an interrupted sweep from its journal
  bool keep_runs = false;           ///< write the files of each run into runs/NUMBER
  bool progress = false;            ///< allow a progress bar
  /// Places of rows in the journal that are known at a time when the table is written, at least 1. The journal is read
  /// once for each so many runs: eight times for a million, some seconds.
  std::size_t most_places = std::size_t{1} << 17;
  /// Is told the processor time of each run that is computed, without the making of its shell [s]: of runs under some
  /// milliseconds, which noise would drown, the least of five. Null: nobody asks.
  std::function<void(std::size_t run, double seconds)> timed = {};

  Shard part() const { return shard.value_or(Shard{}); }
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
  std::size_t resumed = 0;          ///< number of rows taken from the journal
  int signal = 0;                   ///< the signal that stopped the sweep before there was a table, or 0
  std::filesystem::path table;      ///< sweep.csv, or sweep_shard_I_of_N.csv
};

/// The file name, without extension, of what a sweep or one of its shards writes: "sweep", or "sweep_shard_0_of_4".
std::string stem_of(const std::optional<Shard>& shard);

/// The name of a sweep in its journal: equal for sweeps whose rows are the same, with the same files beside them.
std::string journal_title(const SweepPlan& plan, const Shard& shard, bool keep_runs);

/// Runs the shard's part of a plan, `jobs` runs at once, and writes the table and, beside it, a JSON file that says
/// what it holds. Runs in one environment share its shell. Files depend neither on `jobs` nor on interruptions.
///
/// Until the table is written, the rows are in a journal in the same directory, so that a killed sweep loses the runs
/// in flight and at most 10 ms of finished work. Rows of failed runs are not in the journal, so that `resume` tries
/// them again. SIGINT and SIGTERM end the sweep after the runs in flight and leave the journal. Memory: a
/// quarter of a byte a run beside the plan, and 1 MB. Throws InputError when the journal is not of this sweep or in
/// use, and IoError when something cannot be written.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

}  // namespace hapbench
