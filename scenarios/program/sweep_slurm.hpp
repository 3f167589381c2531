#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/sweep_plan.hpp"

/// Sweeps on a cluster that Slurm runs: an array with a task for each shard, and a job behind it that merges them. One
/// task does many runs, since a scheduler starts about one task a second, whatever it does.
namespace hapbench {

struct SlurmOptions {
  std::size_t shards = 0;
  int cpus = 1;           ///< of a task, as many runs at once
  std::string time;       ///< most of a task, as sbatch takes it; empty: the partition's
  std::string partition;  ///< empty: the cluster's default
  bool dry_run = false;   ///< write the scripts only
  bool keep_runs = false;
};

/// What has been given to Slurm.
struct SlurmJobs {
  std::string definition;  ///< of the sweep
  std::size_t runs = 0;
  std::size_t shards = 0;
  std::string array, merge;  ///< numbers of the jobs; no array when all shards were done before
};

/// Writes the scripts sweep.sbatch and merge.sbatch into `directory` and, unless it is a dry run, submits them: the
/// shards that have no table yet, and the merge when they are done. `sweep` is the command, without shard, jobs and
/// output options. Returns what to print. Throws InputError when jobs of an earlier submission are still in the queue,
/// when the directory holds shards of another sweep, or when Slurm refuses; IoError.
std::string submit_to_slurm(const SweepPlan& plan, const SlurmOptions& options, const std::filesystem::path& directory,
                            const std::vector<std::string>& sweep);

/// What was given to Slurm last from this directory; none when nothing was. Throws InputError.
std::optional<SlurmJobs> jobs_of(const std::filesystem::path& directory);

/// Where the log of a shard is.
std::filesystem::path log_of(const std::filesystem::path& directory, std::size_t shard);

/// The states of an array's tasks that are in Slurm's queue, by shard, as "RUNNING" or "PENDING"; none where Slurm does
/// not know the job (any more) or is not there.
std::vector<std::pair<std::size_t, std::string>> queued_tasks(const std::string& array);

}  // namespace hapbench
