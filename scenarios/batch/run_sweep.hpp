#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "scenarios/batch/jobs.hpp"
#include "scenarios/batch/shard.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// Runs the cases of a sweep and writes its table.
namespace hapbench {

struct SweepOptions {
  std::filesystem::path directory = {};  ///< folder of all files; must exist
  JobOptions jobs = {};
  std::optional<Shard> shard = {};  ///< the shard whose runs are executed; empty: all runs
  bool resume = false;     ///< true: keep the rows of an earlier sweep of this plan, except rows of failed runs
  bool keep_runs = false;  ///< true: write the files of each run into runs/NUMBER
  std::function<void()> added = {};  ///< called after the row of each finished run was written to the table

  /// Returns the file of the table: sweep.csv, or the table of the shard.
  std::filesystem::path table() const { return directory / table_name(shard); }
};

struct SweepReport {
  std::size_t resumed = 0;            ///< number of rows that were kept from an earlier sweep
  std::optional<std::size_t> failed;  ///< lowest number of a run that ended with an exception
  std::string problem;                ///< message of this exception
};

/// Runs the cases of a plan, or only the cases of SweepOptions::shard, and writes the table and the JSON file next to
/// it. The files depend neither on the number of jobs nor on interruptions. Runs with the same environment share its
/// point shell. A sweep that is killed loses only unfinished runs; after SIGINT and SIGTERM, started runs are finished.
/// Throws InputError if it would continue the table of another sweep or overwrite finished rows of this sweep. Throws
/// IoError and Stopped.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options);

}  // namespace hapbench
