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

}  // namespace hapbench
