#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <string_view>

#include "results/io/atomic_file.hpp"
#include "scenarios/batch/sweep_row.hpp"
#include "scenarios/input/csv_reader.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The line in front of a shard's table.
std::string title(const Shard& shard, std::size_t runs, std::string_view definition) {
  return fmt::format("# hapbench sweep, shard {} of {} runs, definition {}", shard_text(shard), runs, definition);
}

void append_line(AtomicFile& file, std::string_view line) {
  file.append(line);
  file.append("\n");
}

/// Reads what `title` writes, and nothing that differs from it.
void read_title(std::string_view line, ShardTable& table) {
  const Words words = words_of(line);
  if (words.size() == 10) {
    const Words shard = parts_of(words[4], '/');
    const auto index = whole_number(shard.front()), count = whole_number(shard.back()), runs = whole_number(words[6]);
    if (index && count && runs && *index < *count && *count <= kMostRuns && *runs <= kMostRuns) {
      table.shard = {*index, *count};
      table.runs = *runs;
      table.definition = words[9];
      if (line == title(table.shard, table.runs, table.definition)) return;
    }
  }
  fail_in_line(table.file, 1, "is not the table of a shard, as \"hapbench sweep --shard i/n\" writes it");
}

void check_row(const ShardTable& table, const CsvReader& csv, std::size_t run) {
  if (run >= table.runs) fail_in_line(table.file, csv.line(), "got a row behind the last one");
  const std::string_view number = csv.cells()[0];
  if (whole_number(number) == run) return;
  fail_in_line(table.file, csv.line(), fmt::format("got run \"{}\"; allowed: {}, the next of the shard", number, run));
}

void check_belongs(const ShardTable& table, const ShardTable& first) {
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

}  // namespace

void write_sweep_table(const fs::path& file, const SweepPlan& plan, const std::optional<Shard>& shard,
                       std::span<const std::string> rows) {
  AtomicFile out(file);
  if (shard) append_line(out, title(*shard, plan.points.size(), plan.definition));
  append_line(out, sweep_header(plan));
  for (const std::string& row : rows) append_line(out, row);
  out.commit();
}

Json sweep_description(const SweepPlan& plan, const Shard& shard) {
  Json description = {{"definition", plan.definition}, {"runs", plan.points.size()}, {"shard", shard_text(shard)}};
  description.update(plan.content);
  return description;
}

ShardTable read_shard_table(const fs::path& file) {
  const std::string text = read_named_file(file);
  ShardTable table;
  table.file = file;
  LineReader lines(text);
  read_title(lines.next().value_or(""), table);
  CsvReader csv(lines, file);
  table.header = csv.header();
  if (!table.header.starts_with("index,")) fail_in_line(file, 2, "is not the header of a sweep's table");
  for (std::size_t run = table.shard.index; csv.next(); run += table.shard.count) {
    check_row(table, csv, run);
    table.rows.emplace_back(csv.row());
  }
  const std::size_t rows = table.shard.size(table.runs);
  if (table.rows.size() < rows) {
    fail_in_file(file, fmt::format("ends after {} of {} rows; allowed: complete tables", table.rows.size(), rows));
  }
  if (!text.ends_with('\n')) fail_in_file(file, "ends within a line; allowed: complete tables");
  return table;
}

void check_complete(std::span<const ShardTable> tables) {
  std::map<std::size_t, const ShardTable*> shards;
  for (const ShardTable& table : tables) {
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

void merge_shard_tables(const fs::path& file, std::span<const ShardTable> tables) {
  std::map<std::size_t, const ShardTable*> shards;
  for (const ShardTable& table : tables) shards[table.shard.index] = &table;
  AtomicFile out(file);
  append_line(out, tables.front().header);
  for (std::size_t run = 0; run < tables.front().runs; ++run) {
    append_line(out, shards[run % tables.size()]->rows[run / tables.size()]);
  }
  out.commit();
}

}  // namespace hapbench
