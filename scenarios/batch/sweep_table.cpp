#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/sweep_row.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

void append_line(AtomicFile& file, std::string_view line) {
  file.append(line);
  file.append("\n");
}

void check_belongs(const ShardTitle& table, const ShardTitle& first) {
  const auto differs = [&](const char* what, const std::string& here, const std::string& there) {
    if (here == there) return;
    fail_in_file(table.file, fmt::format("is of another sweep than {}: {} {}, there {}; allowed: shards of one sweep",
                                         first.file.string(), what, here, there));
  };
  differs("definition", table.definition, first.definition);
  differs("runs", std::to_string(table.runs), std::to_string(first.runs));
  differs("shards", std::to_string(table.shard.count), std::to_string(first.shard.count));
  differs("columns", table.header, first.header);
}

/// Of shards' tables those of one sweep differ in nothing but the shard.
constexpr const char* kShardField = "shard";

/// The description beside a table.
fs::path description_of(fs::path table) {
  return table.replace_extension(".json");
}

}  // namespace

void write_sweep_table(const fs::path& file, const SweepPlan& plan, const std::optional<Shard>& shard,
                       const std::function<std::string(std::size_t)>& row) {
  const Shard part = shard.value_or(Shard{});
  AtomicFile out(file);
  if (shard) append_line(out, title_line(part, plan.points.size(), plan.definition));
  append_line(out, sweep_header(plan));
  for (std::size_t run = part.index; run < plan.points.size(); run += part.count) append_line(out, row(run));
  out.commit();
}

Json sweep_description(const SweepPlan& plan, const Shard& shard) {
  Json description = {{"definition", plan.definition}, {"runs", plan.points.size()}, {kShardField, shard_text(shard)}};
  description.update(plan.content);
  return description;
}

void check_complete(std::span<const ShardTitle> tables) {
  std::map<std::size_t, const ShardTitle*> shards;
  for (const ShardTitle& table : tables) {
    check_belongs(table, tables.front());
    const auto [other, is_new] = shards.emplace(table.shard.index, &table);
    if (!is_new) {
      fail_in_file(table.file, fmt::format("is shard {}, as is {}; allowed: each shard once", shard_text(table.shard),
                                           other->second->file.string()));
    }
  }
  const std::size_t count = tables.front().shard.count;
  if (shards.size() == count) return;
  constexpr std::size_t kMostShown = 10;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < count && missing.size() < kMostShown; ++i) {
    if (!shards.contains(i)) missing.push_back(shard_text({i, count}));
  }
  throw InputError(fmt::format("{} of {} shards missing: {}{}", count - shards.size(), count, fmt::join(missing, ", "),
                               count - shards.size() > kMostShown ? ", ..." : ""));
}

std::size_t merge_shard_tables(const fs::path& file, std::span<const fs::path> files) {
  // 64 MB of all together, as far as a page of each allows.
  const std::size_t piece =
      std::clamp((std::size_t{1} << 26) / files.size(), std::size_t{1} << 12, std::size_t{1} << 16);
  std::vector<ShardRows> shards;
  std::vector<ShardTitle> titles;
  for (const fs::path& shard : files) titles.push_back(shards.emplace_back(shard, piece).title());
  check_complete(titles);
  std::sort(shards.begin(), shards.end(),
            [](const ShardRows& a, const ShardRows& b) { return a.title().shard.index < b.title().shard.index; });
  AtomicFile out(file);
  append_line(out, shards[0].title().header);
  for (std::size_t run = 0; run < titles[0].runs; ++run) append_line(out, shards[run % shards.size()].next().value());
  for (ShardRows& shard : shards) shard.next();  // which refuses what is behind the last row
  const fs::path description = description_of(titles[0].file);
  if (std::error_code ignored; fs::is_regular_file(description, ignored)) {
    Json json = parse_json(read_text_file(description, kLargestJsonFile));
    json[kShardField] = shard_text({});
    write_file_atomically(description_of(file), json_text(json));
  }
  out.commit();
  return titles[0].runs;
}

}  // namespace hapbench
