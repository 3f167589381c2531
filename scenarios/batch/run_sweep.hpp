#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/sweep_plan.hpp"

namespace hapbench {

struct SweepOptions {
  std::filesystem::path directory;  ///< for all files; must exist
  std::size_t jobs = 1;             ///< runs at once
  std::optional<Shard> shard;       ///< which runs; none: all
  bool resume = false;     ///< keep the rows that an earlier sweep of this plan has, but for those of failed runs
  bool keep_runs = false;  ///< write the files of each run into runs/NUMBER
  bool progress = false;   ///< allow a progress bar
  /// Is told the processor time of each run that is computed, without the making of its shell [s]: of runs under some
  /// milliseconds, which noise would drown, the least of five. Null: nobody asks.
  std::function<void(std::size_t run, double seconds)> timed = {};

  Shard part() const { return shard.value_or(Shard{}); }
};

/// The table of a sweep or of one of its shards in a folder: sweep.csv, or sweep.0_of_4.csv.
std::filesystem::path table_of(const SweepOptions& options);

/// A run that an exception ended.
struct FailedRun {
  std::size_t run = 0;
  std::string problem;
};

/// What became of a sweep.
struct SweepReport {
  std::size_t done = 0;             ///< number of the shard's runs that have a row
  std::size_t resumed = 0;          ///< number of rows that were there before
  std::optional<FailedRun> failed;  ///< the failed run with the lowest number
  int signal = 0;                   ///< the signal that stopped the sweep before there was a table, or 0
};

/// Runs the shard's part of a plan, `jobs` runs at once, and writes the table and, beside it, a JSON file that says
/// what it holds. Runs in one environment share its shell. Files depend neither on `jobs` nor on interruptions.
///
/// Rows are in the growing table (table_file.hpp) as they come, so that a killed sweep loses the runs in flight.
/// SIGINT and SIGTERM end the sweep after those, and leave it. Throws InputError when with `resume` there is the table
/// of another sweep, and IoError when something cannot be written.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

}  // namespace hapbench
