#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/shard.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// The files a sweep leaves. The table of a shard is one of the sweep, behind a line that says of which.
namespace hapbench {

/// Writes the rows, which are in order and complete. Throws IoError.
void write_sweep_table(const std::filesystem::path& file, const SweepPlan& plan, const std::optional<Shard>& shard,
                       std::span<const std::string> rows);

/// What the table is about.
Json sweep_description(const SweepPlan& plan, const Shard& shard);

/// The table of a shard.
struct ShardTable {
  std::filesystem::path file;
  Shard shard;
  std::size_t runs = 0;           ///< of the whole sweep
  std::string definition;         ///< of the sweep
  std::string header;             ///< line without its end, as are the rows
  std::vector<std::string> rows;  ///< in order and complete
};

/// Reads and checks the table of a shard. Throws InputError that names file and line.
ShardTable read_shard_table(const std::filesystem::path& file);

/// Throws InputError when the tables are not those of all shards of one sweep, each once. Precondition: there are any.
void check_complete(std::span<const ShardTable> shards);

/// Writes what the sweep without shards writes. Precondition: check_complete. Throws IoError.
void merge_shard_tables(const std::filesystem::path& file, std::span<const ShardTable> shards);

}  // namespace hapbench
