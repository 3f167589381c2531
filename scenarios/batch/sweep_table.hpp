#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "scenarios/batch/shard_rows.hpp"
#include "scenarios/batch/sweep_plan.hpp"

/// The files a sweep leaves. The table of a shard is one of the sweep, behind a line that says of which.
namespace hapbench {

/// Writes the rows of the shard's runs, which are asked for in their order. Throws IoError.
void write_sweep_table(const std::filesystem::path& file, const SweepPlan& plan, const std::optional<Shard>& shard,
                       const std::function<std::string(std::size_t run)>& row);

/// What the table is about.
Json sweep_description(const SweepPlan& plan, const Shard& shard);

/// Throws InputError when the tables are not those of all shards of one sweep, each once. Precondition: there are any.
void check_complete(std::span<const ShardTitle> shards);

/// Puts the tables of all shards of a sweep together, row by row: writes what the sweep without shards writes, the
/// table and, when that of a shard has one beside it, its description. Throws InputError for tables that are damaged,
/// incomplete or not of one sweep, IoError. Returns the number of rows.
std::size_t merge_shard_tables(const std::filesystem::path& file, std::span<const std::filesystem::path> shards);

}  // namespace hapbench
