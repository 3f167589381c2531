#include "scenarios/batch/shard.hpp"

#include <fmt/format.h>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

Shard parse_shard(const std::string& text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto index = whole_number(std::string_view(text).substr(0, slash));
  const auto count = whole_number(std::string_view(text).substr(std::min(slash + 1, text.size())));
  if (!index || !count || *index >= *count || *count > kMostRuns) {
    throw InputError(
        fmt::format("--shard: got \"{}\"; allowed: i/n with 0 <= i < n <= {}, as in 0/4", text, kMostRuns));
  }
  return {*index, *count};
}

std::string shard_text(const Shard& shard) {
  return fmt::format("{}/{}", shard.index, shard.count);
}

}  // namespace hapbench
