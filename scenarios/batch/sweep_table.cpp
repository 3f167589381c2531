#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The cells in front of the metrics: run, varied fields, outcome, expected, steps.
std::size_t leading_columns(const SweepPlan& plan) {
  return 1 + plan.points.axes().size() + 3;
}

std::size_t cells_in(std::string_view line) {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
}

/// The number in a cell: a count if it is a whole number, so that it is printed as it is in the table.
Metric::Value value_in(std::string_view cell) {
  if (const auto count = whole_number(cell)) return static_cast<std::uint64_t>(*count);
  if (const auto number = finite_number(cell)) return *number;
  return {};
}

Json json_of(const Metric::Value& value) {
  return std::visit(
      [](const auto& number) {
        if constexpr (std::is_same_v<std::decay_t<decltype(number)>, std::monostate>)
          return Json(nullptr);
        else
          return Json(number);
      },
      value);
}

/// The value of a varied field, whose type is not known.
Json json_of_text(const std::string& text) {
  if (text == "true" || text == "false") return text == "true";
  const Metric::Value value = value_in(text);
  return std::holds_alternative<std::monostate>(value) ? Json(text) : json_of(value);
}

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

/// The only field in which the descriptions of a sweep's shards differ.
constexpr const char* kShardField = "shard";

/// The description beside a table.
fs::path description_of(fs::path table) {
  return table.replace_extension(".json");
}

}  // namespace

// ---- Shards

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

// ---- Rows

std::optional<double> SweepRow::number(const SweepPlan& plan, std::string_view metric) const {
  const auto column = std::find(plan.metrics.begin(), plan.metrics.end(), metric) - plan.metrics.begin();
  return number_of(metrics[static_cast<std::size_t>(column)]);
}

std::optional<double> SweepRow::tolerance(const SweepPlan& plan, std::string_view metric) const {
  const auto name = std::find(plan.bounded.begin(), plan.bounded.end(), metric);
  if (name == plan.bounded.end()) return std::nullopt;
  return number_of(tolerances[static_cast<std::size_t>(name - plan.bounded.begin())]);
}

SweepRow sweep_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary) {
  SweepRow row{.run = run,
               .outcome = std::string(outcome_name(summary.result.outcome)),
               .expected = summary.expected,
               .steps = static_cast<std::size_t>(summary.result.rows),
               .metrics = {},
               .tolerances = {},
               .state_hash = hash_text(summary.metrics.state_hash)};
  const MetricList metrics = metric_list(summary);
  auto next = metrics.begin();  // the columns are in the same order, but some runs have more metrics than others
  for (const std::string& name : plan.metrics) {
    const bool is_it = next != metrics.end() && next->name == name;
    row.metrics.push_back(is_it ? next->value : Metric::Value());
    if (is_it) ++next;
  }
  if (next != metrics.end()) {
    throw InputError(
        fmt::format("has the metric {}, for which no run that was checked before the first one has a column; allowed: "
                    "sweeps whose first runs record what the others record",
                    next->name));
  }
  for (const std::string& name : plan.bounded) {
    const Metric* metric = find_metric(metrics, name);
    const auto tolerance = metric != nullptr ? metric->tolerance() : std::nullopt;
    row.tolerances.push_back(tolerance ? Metric::Value(*tolerance) : Metric::Value());
  }
  return row;
}

SweepRow error_row(const SweepPlan& plan, std::size_t run) {
  return {.run = run,
          .outcome = std::string(kErrorOutcome),
          .expected = false,
          .steps = std::nullopt,
          .metrics = std::vector<Metric::Value>(plan.metrics.size()),
          .tolerances = std::vector<Metric::Value>(plan.bounded.size()),
          .state_hash = ""};
}

std::string sweep_header(const SweepPlan& plan) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : plan.points.axes()) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  columns.insert(columns.end(), plan.metrics.begin(), plan.metrics.end());
  for (const std::string& metric : plan.bounded) columns.push_back(std::string(kToleranceOf) + metric);
  columns.emplace_back("state_hash");
  return fmt::format("{}", fmt::join(columns, ","));
}

std::string row_text(const SweepPlan& plan, const SweepRow& row) {
  std::string text = fmt::format("{},{},{},{},{}", row.run, fmt::join(plan.points.values(row.run), ","), row.outcome,
                                 row.expected, row.steps ? std::to_string(*row.steps) : "");
  for (const auto* values : {&row.metrics, &row.tolerances}) {
    for (const Metric::Value& value : *values) text += "," + cell_text(value);
  }
  return text + "," + row.state_hash;
}

std::optional<SweepRow> parse_row(const SweepPlan& plan, std::string_view text) {
  const Words cells = parts_of(text, ',');
  const std::size_t axes = plan.points.axes().size(), first_metric = leading_columns(plan);
  const auto run = whole_number(cells[0]);
  if (!run || *run >= plan.points.size() ||
      cells.size() != first_metric + plan.metrics.size() + plan.bounded.size() + 1)
    return std::nullopt;
  for (std::size_t a = 0; a < axes; ++a)
    if (cells[1 + a] != plan.points.value(*run, a)) return std::nullopt;
  SweepRow row{.run = *run,
               .outcome = std::string(cells[1 + axes]),
               .expected = cells[2 + axes] == "true",
               .steps = whole_number(cells[3 + axes]),
               .metrics = {},
               .tolerances = {},
               .state_hash = std::string(cells.back())};
  row.metrics.reserve(plan.metrics.size());
  for (std::size_t m = first_metric; m + 1 < cells.size(); ++m)
    (row.metrics.size() < plan.metrics.size() ? row.metrics : row.tolerances).push_back(value_in(cells[m]));
  return row;
}

Json row_json(const SweepPlan& plan, const SweepRow& row) {
  Json json = {{"index", row.run}};
  for (std::size_t a = 0; a < plan.points.axes().size(); ++a)
    json[plan.points.axes()[a].path] = json_of_text(plan.points.value(row.run, a));
  json["outcome"] = row.outcome;
  json["expected"] = row.expected;
  json["steps"] = row.steps ? Json(*row.steps) : Json(nullptr);
  for (std::size_t m = 0; m < plan.metrics.size(); ++m) json[plan.metrics[m]] = json_of(row.metrics[m]);
  for (std::size_t m = 0; m < plan.bounded.size(); ++m)
    json[std::string(kToleranceOf) + plan.bounded[m]] = json_of(row.tolerances[m]);
  json["state_hash"] = row.state_hash.empty() ? Json(nullptr) : Json(row.state_hash);
  return json;
}

void SweepCounts::add(const SweepRow& row) {
  const bool is_failure = row.outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[row.outcome];
  ++count.runs;
  if (row.expected) ++count.expected;
  if (is_failure) ++failed;
  if (is_failure || row.expected) return;
  ++unexpected;
  if (!first_unexpected) first_unexpected = row.run;
}

// ---- Tables of shards

std::string title_line(const Shard& shard, std::size_t runs, std::string_view definition) {
  return fmt::format("# hapbench sweep, shard {} of {} runs, definition {}", shard_text(shard), runs, definition);
}

ShardRows::ShardRows(fs::path file, std::size_t piece) : piece_(piece) {
  title_.file = std::move(file);
  read_title(line().value_or(""));
  title_.header = line().value_or("");
  if (!title_.header.starts_with("index,")) fail_in_line(title_.file, 2, "is not the header of a sweep's table");
  columns_ = cells_in(title_.header);
  run_ = title_.shard.index;
}

/// Accepts exactly what `title_line` writes.
void ShardRows::read_title(std::string_view line) {
  const Words words = words_of(line);
  if (words.size() == 10) {
    const Words shard = parts_of(words[4], '/');
    const auto index = whole_number(shard.front()), count = whole_number(shard.back()), runs = whole_number(words[6]);
    if (index && count && runs && *index < *count && *count <= kMostRuns && *runs <= kMostRuns) {
      title_.shard = {*index, *count};
      title_.runs = *runs;
      title_.definition = words[9];
      if (line == title_line(title_.shard, title_.runs, title_.definition)) return;
    }
  }
  fail_in_line(title_.file, 1, "is not the table of a shard, as \"hapbench sweep --shard i/n\" writes it");
}

std::optional<std::string_view> ShardRows::next() {
  const auto row = line();
  if (run_ >= title_.runs) {
    if (row) fail_in_line(title_.file, lines_, "got a row behind the last one");
    return std::nullopt;
  }
  if (!row) {
    const std::size_t rows = title_.shard.size(title_.runs);
    fail_in_file(title_.file,
                 fmt::format("ends after {} of {} rows; allowed: complete tables", run_ / title_.shard.count, rows));
  }
  if (cells_in(*row) != columns_)
    fail_in_line(title_.file, lines_, fmt::format("got {} cells; allowed: {}", cells_in(*row), columns_));
  const std::string_view number = row->substr(0, row->find(','));
  if (whole_number(number) != run_)
    fail_in_line(title_.file, lines_, fmt::format("got run \"{}\"; allowed: {}, the next of the shard", number, run_));
  run_ += title_.shard.count;
  return row;
}

std::optional<std::string_view> ShardRows::line() {
  std::size_t end = 0;
  while ((end = text_.find('\n', given_)) == std::string::npos) {
    if (read_piece()) continue;
    if (given_ < text_.size()) fail_in_file(title_.file, "ends within a line; allowed: complete tables");
    return std::nullopt;
  }
  const auto line = std::string_view(text_).substr(given_, end - given_);
  given_ = end + 1;
  ++lines_;
  return line;
}

bool ShardRows::read_piece() {
  text_.erase(0, given_);
  given_ = 0;
  std::error_code error;
  std::ifstream in(title_.file, std::ios::binary);
  if (!in || !fs::is_regular_file(title_.file, error))
    fail_in_file(title_.file, "is no file that can be read; allowed: sweep_shard_I_of_N.csv of a sweep");
  in.seekg(static_cast<std::streamoff>(offset_));
  const std::size_t before = text_.size();
  text_.resize(before + piece_);
  in.read(text_.data() + before, static_cast<std::streamsize>(piece_));
  const auto length = static_cast<std::size_t>(in.gcount());
  text_.resize(before + length);
  offset_ += length;
  return length > 0;
}

// ---- Tables

void write_sweep_table(const fs::path& file, const SweepPlan& plan, const std::optional<Shard>& shard,
                       const std::function<std::string(std::size_t)>& row, FileSet& files) {
  const Shard part = shard.value_or(Shard{});
  AtomicFile out(file);
  if (shard) append_line(out, title_line(part, plan.points.size(), plan.definition));
  append_line(out, sweep_header(plan));
  for (std::size_t run = part.index; run < plan.points.size(); run += part.count) append_line(out, row(run));
  files.take(std::move(out));
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
  for (std::size_t i = 0; i < count && missing.size() < kMostShown; ++i)
    if (!shards.contains(i)) missing.push_back(shard_text({i, count}));
  throw InputError(fmt::format("{} of {} shards missing: {}{}", count - shards.size(), count, fmt::join(missing, ", "),
                               count - shards.size() > kMostShown ? ", ..." : ""));
}

std::size_t merge_shard_tables(const fs::path& file, std::span<const fs::path> files) {
  // All pieces together take 64 MB, unless that leaves less than a page for each file.
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
  for (ShardRows& shard : shards) shard.next();  // refuses anything after the last row
  FileSet both;
  both.take(std::move(out));
  const fs::path description = description_of(titles[0].file);
  if (std::error_code ignored; fs::is_regular_file(description, ignored)) {
    Json json = parse_json(read_text_file(description, kLargestJsonFile));
    json[kShardField] = shard_text({});
    both.write(description_of(file), json_text(json));
  }
  both.commit();
  return titles[0].runs;
}

}  // namespace hapbench
