#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/program/slurm.hpp"

/// The parts of `hapbench sweep`: what it prints of a finished sweep, and sweeps on a cluster.
namespace hapbench {

/// The metric that `sweep` shows: the one asked for, or else the first of kDefaultMetrics that the runs have. Throws
/// InputError when they have none of that name.
std::string chosen_metric(const SweepPlan& plan, const std::string& asked_for);

/// The counts of outcomes, and above them for a sweep of one field the runs (up to 100) with their main metrics, for a
/// grid of two fields (up to 400 cells) the metric as a table and a map of characters, else the 20 runs with the least
/// of the metric. Precondition: `metric` is among the plan's.
std::string summary_text(const SweepPlan& plan, const SweepReport& report, const std::string& metric);
/// The counts, and the rows that the report has.
Json summary_json(const SweepPlan& plan, const SweepReport& report);

/// Refuses to begin anew, without --resume, where the finished runs of the same sweep would be lost, and tells when
/// those of another are.
void check_journal(const SweepPlan& plan, const SweepOptions& options);

/// A submission to Slurm.
struct SlurmJobs {
  std::string definition;  ///< of the sweep
  std::size_t runs = 0;
  std::size_t shards = 0;
  std::string array, merge;  ///< numbers of the jobs; no array when all shards were done before
  std::string text;          ///< to print
};

/// Submits a sweep to Slurm as an array with a task for each shard that has no table yet, and a job that merges the
/// shards when all are done. A task does many runs, since a scheduler starts only about one task a second. Writes the
/// scripts sweep.sbatch and merge.sbatch into the sweep's directory; a dry run ends there. `command` is the sweep's
/// without shard, jobs and output options. Throws InputError when jobs of an earlier submission are still in the queue,
/// when the directory holds shards of another sweep, or when Slurm refuses; IoError.
SlurmJobs submit_to_slurm(const SweepPlan& plan, const SlurmOptions& options, const SweepOptions& sweep,
                          const std::vector<std::string>& command);

/// The progress of the sweep in a directory.
struct SweepStatus {
  std::string text;
  Json json;
};

/// Reads the files of a sweep and its shards, and Slurm's queue when they were submitted to Slurm. Throws InputError
/// when the directory holds no sweep, or shards of several.
SweepStatus sweep_status(const std::filesystem::path& directory);

}  // namespace hapbench
