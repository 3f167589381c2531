#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// How far a shard is.
enum class ShardState {
  done,     ///< its table is there
  running,  ///< a process writes its journal, or Slurm says so
  waiting,  ///< in Slurm's queue, perhaps again
  failed,   ///< begun, not done, and nobody is at it: killed, preempted, out of time, or a wrong command
  missing   ///< never begun
};

struct ShardStatus {
  Shard shard;
  ShardState state = ShardState::missing;
  std::size_t done = 0;  ///< runs, as far as they are on disk
};

/// How far the sweep in a directory is.
struct SweepStatus {
  std::vector<ShardStatus> shards;  ///< all of them; of a sweep without shards one
  std::optional<std::size_t> runs;  ///< of the whole sweep, when some file says so
  std::string array, merge;         ///< Slurm's numbers of the jobs submitted last; empty for none
  bool merged = false;              ///< sweep.csv is there
};

/// Looks at the files of a sweep and its shards, and at Slurm's queue when they were given to Slurm. Throws InputError
/// when the directory holds no sweep, or shards of several.
SweepStatus sweep_status(const std::filesystem::path& directory);

std::string status_text(const SweepStatus& status);
Json status_json(const SweepStatus& status);

}  // namespace hapbench
