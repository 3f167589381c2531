#pragma once

#include <cstddef>
#include <optional>
#include <string>

/// Shards: parts of a sweep of nearly equal size, which several machines can run.
namespace hapbench {

/// A shard contains the cases whose position in the execution order leaves the remainder `index` when divided by
/// `count`. By default, it contains all cases.
struct Shard {
  std::size_t index = 0, count = 1;
};

/// Parses "i/n" with 0 <= i < n. Throws InputError.
Shard parse_shard(const std::string& text);

/// Returns "i/n".
inline std::string shard_text(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

/// Returns the file name of a sweep's table, sweep.csv, or of the table of one of its shards, such as
/// sweep.0_of_4.csv.
std::string table_name(const std::optional<Shard>& shard);

}  // namespace hapbench
