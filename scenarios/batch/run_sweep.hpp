#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/shard.hpp"
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
  std::vector<std::string> rows;    ///< of the shard, by run number; incomplete when a signal came
  std::optional<FailedRun> failed;  ///< the first of those that failed
  std::size_t resumed = 0;          ///< rows that were in the journal
  int signal = 0;                   ///< the signal that stopped it, or 0
  std::filesystem::path table;      ///< sweep.csv, or sweep_shard_I_of_N.csv
};

/// Runs the shard's part of a plan, `jobs` runs at once, runs in one environment sharing its shell, and writes the
/// table and, beside it, a JSON file that says what it holds. Files depend neither on `jobs` nor on interruptions.
/// Until then each row is in a journal in the same directory, so that a killed sweep loses no more than the runs in
/// flight; rows of failed runs are not, so that `resume` tries them again. SIGINT and SIGTERM end it after the runs in
/// flight and leave the journal. Throws InputError when the journal is not of this sweep or in use, IoError when
/// something cannot be written.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

}  // namespace hapbench
