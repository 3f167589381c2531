#pragma once

#include <cstddef>
#include <optional>
#include <string>

/// Shards: equal parts of a sweep, which several machines run.
namespace hapbench {

/// The cases whose place in the order of the runs leaves the remainder `index` when divided by `count`; by default all.
struct Shard {
  std::size_t index = 0, count = 1;
};

/// Reads "i/n" with 0 <= i < n. Throws InputError.
Shard parse_shard(const std::string& text);

/// "i/n"
inline std::string shard_text(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

/// The file of a sweep, sweep.csv, or of one of its shards, sweep.0_of_4.csv.
std::string table_name(const std::optional<Shard>& shard);

}  // namespace hapbench
