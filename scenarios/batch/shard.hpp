#pragma once

#include <cstddef>
#include <string>

namespace hapbench {

/// A part of a sweep: the runs whose number leaves the remainder `index` when divided by `count`. By default all.
struct Shard {
  std::size_t index = 0;
  std::size_t count = 1;

  bool has(std::size_t run) const { return run % count == index; }
  /// Number of the sweep's runs that belong to this shard.
  std::size_t size(std::size_t runs) const { return (runs + count - 1 - index) / count; }
};

/// Reads "i/n" with 0 <= i < n. Throws InputError.
Shard parse_shard(const std::string& text);

/// "i/n"
std::string shard_text(const Shard& shard);

}  // namespace hapbench
