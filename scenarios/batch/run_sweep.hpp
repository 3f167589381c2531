#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/shard.hpp"
#include "scenarios/batch/sweep_counts.hpp"
#include "scenarios/batch/sweep_plan.hpp"

namespace hapbench {

struct SweepOptions {
  std::filesystem::path directory;  ///< of all files; exists
  std::size_t jobs = 1;             ///< runs at once
  std::optional<Shard> shard;       ///< which runs; none: all, in a table that needs no merging
  bool resume = false;              ///< take the rows of an interrupted sweep from its journal
  bool keep_runs = false;           ///< write the files of each run into runs/NUMBER
  bool progress = false;            ///< allow a progress bar

  Shard part() const { return shard.value_or(Shard{}); }
};

/// A run that an exception ended.
struct FailedRun {
  std::size_t run = 0;
  std::string problem;
};

/// Result of a sweep.
struct SweepReport {
  /// Most rows that a report has.
  static constexpr std::size_t kMostRows = 10'000;

  std::size_t done = 0;             ///< runs that have a row, of the shard
  SweepCounts counts;               ///< of the table
  std::vector<std::string> rows;    ///< of the table, by run number; none of a longer one
  std::optional<FailedRun> failed;  ///< the first of those that failed
  std::size_t resumed = 0;          ///< rows that were in the journal
  int signal = 0;                   ///< the signal that stopped it before there was a table, or 0
  std::filesystem::path table;      ///< sweep.csv, or sweep_shard_I_of_N.csv
};

/// The file name, without extension, of what a sweep or one of its shards writes: "sweep", or "sweep_shard_0_of_4".
std::string stem_of(const std::optional<Shard>& shard);

/// What its journal names a sweep: equal for sweeps whose rows are the same, with the same files beside them.
std::string journal_title(const SweepPlan& plan, const Shard& shard, bool keep_runs);

/// Runs the shard's part of a plan, `jobs` runs at once, runs in one environment sharing its shell, and writes the
/// table and, beside it, a JSON file that says what it holds. Files depend neither on `jobs` nor on interruptions.
/// Until then the rows are in a journal in the same directory, so that a killed sweep loses the runs in flight and no
/// more than 10 ms of work besides; rows of failed runs are not, so that `resume` tries them again. SIGINT and SIGTERM
/// end it after the runs in flight and leave the journal. Memory: 8 bytes a run, and as many again where fields of the
/// environment vary. Throws InputError when the journal is not of this sweep or in use, IoError when something cannot
/// be written.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

}  // namespace hapbench
