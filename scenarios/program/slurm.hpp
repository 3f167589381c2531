#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/program/command.hpp"

/// Commands that submit themselves to Slurm: an array of jobs with a task for each shard, and a job after them.
namespace hapbench {

struct SlurmOptions {
  std::size_t shards = 0;
  int cpus = 1;           ///< per task, which does as many runs at once
  std::string time;       ///< limit of a task, as sbatch takes it; empty: the partition's
  std::string partition;  ///< empty: the cluster's default
  bool dry_run = false;   ///< only writes the scripts
};

/// Adds --slurm, --time, --cpus, --partition and --dry-run; --slurm excludes --shard.
void add_slurm_options(Command& command, SlurmOptions& options, CommandOption& shard, const std::string& help);

/// A script for sbatch.
struct SlurmScript {
  std::filesystem::path file;
  std::string text;
};

/// The script NAME.sbatch in an absolute directory, whose job is hapbench-NAME and writes the log file there. `fields`
/// are further options of sbatch, without dashes; `lines` is what the job does. Throws InputError for --time,
/// --partition or a directory that would end the line they stand in.
SlurmScript slurm_script(const SlurmOptions& options, const std::filesystem::path& directory, const std::string& name,
                         const std::string& log, const std::vector<std::string>& fields, const std::string& lines);

/// Numbers in order as the field "array" takes them: "0-3,7".
std::string array_text(const std::vector<std::size_t>& numbers);

/// Submits a script and returns the number of the new job, which waits until those of the job `after` have succeeded;
/// empty: it does not wait. Throws InputError with what sbatch says when it refuses.
std::string submit_script(const SlurmScript& script, const std::string& after = "");

/// The output of a dry run: the scripts, and the commands that submit them so that each waits for the one before.
std::string dry_run_text(const std::vector<SlurmScript>& scripts);

}  // namespace hapbench
