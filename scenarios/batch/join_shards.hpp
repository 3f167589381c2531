#pragma once

#include <filesystem>

/// Joins the tables of the shards of a sweep.
namespace hapbench {

/// Joins the tables of all shards that are in a folder into sweep.csv. False when there are none, or not all beside a
/// whole table. Throws InputError for tables that are damaged, incomplete or not of one definition, and IoError.
bool join_shards(const std::filesystem::path& folder);

}  // namespace hapbench
