#include "scenarios/batch/shard.hpp"

#include <fmt/format.h>

#include "scenarios/batch/axis.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

Shard parse_shard(const std::string& text) {
  const Words parts = parts_of(text, '/');
  const auto index = whole_number(parts[0]), count = parts.size() == 2 ? whole_number(parts[1]) : std::nullopt;
  if (!index || !count || *index >= *count || *count > kMaxRuns) {
    fail_in_option("--shard",
                   fmt::format("got \"{}\"; allowed: i/n with 0 <= i < n <= {}, such as 0/4", text, kMaxRuns));
  }
  return {*index, *count};
}

std::string table_name(const std::optional<Shard>& shard) {
  return shard ? fmt::format("sweep.{}_of_{}.csv", shard->index, shard->count) : "sweep.csv";
}

}  // namespace hapbench
