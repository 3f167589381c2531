#pragma once

#include <filesystem>

/// Joins the tables of the shards of a sweep.
namespace hapbench {

/// Joins the tables of all shards in a folder into sweep.csv. Returns false if the folder has no table of a shard, or
/// if some tables are missing and sweep.csv already exists. Throws InputError if some tables are missing and sweep.csv
/// does not exist, or if tables are damaged, incomplete or from different sweeps. Throws IoError.
bool join_shards(const std::filesystem::path& folder);

}  // namespace hapbench
