#include "scenarios/batch/run_sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <fstream>
#include <mutex>
#include <numeric>
#include <set>
#include <utility>

#include "algorithms/registry.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/describe_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

// ---- The plan

/// The facts about one run's scenario that the sweep needs.
struct Point {
  std::vector<std::string> warnings;
  MetricList metrics;
  std::string files;  ///< the folder and the objects that name files
  AlgorithmOrigin origin;
};

Point examine(const SweepPlan& plan, std::size_t run) {
  const LoadedScenario loaded = plan.cases.load(run);
  const Scenario& scenario = loaded.scenario;
  Point point{with_files(loaded, loaded.warnings),
              metrics_without_values(scenario, scenario.reference_force.has_value()), "",
              find_algorithm(scenario.rendering.algorithm)->origin};
  if (loaded.files.all().empty()) return point;
  const Json json = written_object(scenario);
  point.files = loaded.file.parent_path().string() + "\n";
  for (const auto& file : loaded.files.all()) {
    const Json::json_pointer field(file->pointer());
    point.files += file->pointer() + " " + json.at(field.parent_pointer()).dump() + "\n";
  }
  return point;
}

using Names = std::set<std::string>;

void add_names(Names& names, const MetricList& metrics) {
  for (const Metric& metric : metrics) names.insert(metric.name);
}

/// Reads the files that the scenarios of these runs name, adds their warnings to the plan and the metrics of what they
/// measured, and returns their hashes.
Json check_files(SweepPlan& plan, const std::vector<std::size_t>& runs, Names& metrics) {
  Json hashes = Json::array();
  for (const std::size_t run : runs) {
    LoadedScenario loaded = checked(plan.cases.load(run));
    append_new(plan.warnings, with_files(loaded, loaded.file_warnings));
    if (std::holds_alternative<RecordedPosition>(loaded.scenario.motion.position)) {
      const bool has_force = loaded.files.at(kMotionFile).stroke()->force.has_value();
      add_names(metrics, metrics_without_values(loaded.scenario, has_force));
    }
    loaded.scenario.name.clear();  // may be that of the scenario's file
    hashes.push_back(
        with_file(loaded, [&] { return scenario_hash(effective_scenario(loaded.scenario, {}), loaded.files); }));
  }
  return hashes;
}

/// The values of an axis; only the ends of a range that has very many.
Json axis_content(const Axis& axis, bool of_a_file) {
  constexpr std::size_t kMostListed = 10'000;
  Json content = {{"path", axis.path}};
  if (of_a_file) return content;
  if (axis.range && (axis.steps == 0 || axis.steps > kMostListed)) {
    content["range"] = {axis.range->from, axis.range->to};
    content["scale"] = axis.range->logarithmic ? "log" : "linear";
    if (axis.steps > 0) content["count"] = axis.steps;
    return content;
  }
  content["values"] = Json::array();
  for (std::size_t i = 0; i < axis.size(); ++i) content["values"].push_back(axis.value(i));
  for (const Axis::Along& along : axis.along)
    content["along"].push_back({{"set", along.overrides}, {"metrics_every_rows", along.stride}});
  return content;
}

std::string hash_of_points(const Cases& cases) {
  std::string text;
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const std::string& change : cases.changes(i)) text += change + "\n";
  return hash_text(hash_of(text));
}

/// The CPU does not count: shards of one sweep may come from several machines.
Json content_of(const SweepPlan& plan, const Json& files, const Json& plugins) {
  const Provenance program = provenance();
  const std::vector<ScenarioText>& scenes = plan.cases.scenes();
  const auto& sampling = plan.cases.sampling();
  const bool of_a_file = sampling && sampling->method == kPointsOfFile;
  Json content;
  if (scenes.size() == 1) content["scenario"] = scenes[0].json;
  if (scenes.size() > 1)
    for (const ScenarioText& scene : scenes) content["scenarios"].push_back(scene.json);
  content["set"] = plan.cases.sets();
  content["vary"] = Json::array();
  for (const Axis& axis : plan.cases.axes()) content["vary"].push_back(axis_content(axis, of_a_file));
  if (sampling) content["sample"] = {{"method", sampling->method}, {"runs", sampling->count}};
  if (of_a_file) content["sample"]["hash"] = hash_of_points(plan.cases);
  if (sampling && !of_a_file) content["sample"]["seed"] = sampling->seed;
  content["files"] = files;
  if (!plugins.empty()) content["plugins"] = plugins;
  content["program"] = {{"hapbench_version", program.version},
                        {"commit", program.commit},
                        {"compiler", program.compiler},
                        {"build_type", program.build_type},
                        {"flags", program.flags}};
  return content;
}

fs::path run_folder(const SweepOptions& options, std::size_t run) {
  return options.directory / "runs" / fmt::format("{:06}", run);
}

/// The line of a run, without its end: its number and varied fields, and these cells behind them.
std::string line_of(const SweepPlan& plan, std::size_t run, const std::vector<std::string>& cells) {
  std::string line = std::to_string(run);
  for (const std::string& value : plan.cases.values(run)) line += "," + csv_cell(value);
  for (const std::string& cell : cells) line += "," + cell;
  return line;
}

std::string error_row(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = {std::string(kErrorOutcome), "false"};
  cells.resize(plan.columns().size() - plan.cases.axes().size() - 1);
  return line_of(plan, run, cells);
}

std::string finished_row(const SweepPlan& plan, std::size_t run, const Result& summary) {
  std::vector<std::string> cells = {std::string(outcome_name(summary.end.outcome)), summary.expected ? "true" : "false",
                                    std::to_string(summary.end.rows)};
  const MetricList& metrics = summary.metrics;
  for (const Metric& metric : metrics) {
    if (std::ranges::find(plan.metrics, metric.name) != plan.metrics.end()) continue;
    throw InputError(
        fmt::format("has the metric {}, for which no run that was checked before the first one has a column; allowed: "
                    "sweeps whose first runs record what the others record",
                    metric.name));
  }
  for (const std::string& name : plan.metrics) cells.push_back(cell_text(value_of(metrics, name)));
  for (const std::string& name : plan.bounded) {
    const Metric* metric = find_metric(metrics, name);
    cells.push_back(metric == nullptr ? "" : cell_text(cell_of(metric->tolerance())));
  }
  cells.push_back(hash_text(summary.state_hash));
  return line_of(plan, run, cells);
}

using Condition = std::function<bool(const SweepRow& row)>;

Condition condition_of(const std::string& text, const SweepTable& table) {
  static const std::map<std::string, std::function<bool(double, double)>> kSigns = {
      {"<", std::less<>()},           {">", std::greater<>()},  {"<=", std::less_equal<>()},
      {">=", std::greater_equal<>()}, {"=", std::equal_to<>()}, {"!=", std::not_equal_to<>()}};
  const std::size_t begin = std::min(text.find_first_of("<>=!"), text.size());
  const std::size_t end = std::min(text.find_first_not_of("<>=!", begin), text.size());
  const std::string name = text.substr(0, begin), sign = text.substr(begin, end - begin), value = text.substr(end);
  const auto number = finite_number(value);
  const auto holds = kSigns.find(sign);
  if (holds == kSigns.end() || value.empty() || (!number && sign != "=" && sign != "!=")) {
    throw InputError(fmt::format(
        "--where: got \"{}\"; allowed: a column of sweep.csv, one of < <= > >= = !=, and a number (a text with = and !=), "
        "as inside_max_m<3e-4 or outcome=completes",
        text));
  }
  require_valid_name("--where: got", name, table.columns, "hapbench describe sweep.csv");
  return [=, compare = holds->second, column = table.place(name)](const SweepRow& row) {
    if (!number) return (row[column] == value) == (sign == "=");
    const auto found = finite_number(row[column]);
    return found && compare(*found, *number);
  };
}

/// The JSON next to a table, which has a definition. Throws InputError.
Json description_of(const fs::path& file) {
  Json about = with_file(file, [&] { return read_json(file); });
  if (!about.contains("definition")) fail_in_file(file, "is not the description of a sweep");
  return about;
}

// ---- The table while it grows

fs::path part_of(fs::path file) {
  return file += ".part";
}

fs::path beside(fs::path table) {
  return table.replace_extension(".json");
}

/// The definition in the JSON next to a table; empty when there is none to be read.
std::string definition_in(const fs::path& about) {
  try {
    return description_of(about)["definition"].get<std::string>();
  } catch (const std::exception&) {
    return "";
  }
}

/// The whole lines of a table: the header, then its rows with the numbers of their cases.
class TableLines {
 public:
  TableLines(const fs::path& file, std::size_t cases) : file_(file), cases_(cases), in_(file, std::ios::binary) {}

  /// The next line; false at the end, and where a line has no end.
  bool next() {
    begin_ = end_;
    if (!std::getline(in_, line_) || in_.eof()) return false;
    end_ += line_.size() + 1;
    ++number_;
    return true;
  }
  const std::string& line() const { return line_; }
  std::uintmax_t begin() const { return begin_; }
  /// Returns the offset of the end of the last whole line [bytes].
  std::uintmax_t end() const { return end_; }
  /// The number of the row's case. Throws InputError.
  std::size_t row() const {
    const auto row = whole_number(std::string_view(line_).substr(0, line_.find(',')));
    if (row && *row < cases_) return *row;
    refuse();
  }
  [[noreturn]] void refuse(const std::string& problem) const { fail_in_line(file_, number_, problem); }
  [[noreturn]] void refuse() const {
    refuse(fmt::format("got the row \"{}\"; allowed: rows of this table", line_.substr(0, 60)));
  }

 private:
  fs::path file_;
  std::size_t cases_;
  std::ifstream in_;
  std::string line_;
  std::uintmax_t begin_ = 0, end_ = 0;
  std::size_t number_ = 0;
};

/// Gives the table its rows, those of these files in the order of their numbers, of two of one case the later, and its
/// JSON. Returns their number; when it is not `rows`, writes nothing. Throws InputError for other tables, and IoError.
std::size_t put_in_order(const TableTitle& title, const std::vector<fs::path>& parts, std::size_t rows) {
  // Places as if one file followed the other; 0, where a header stands: no row.
  std::vector<std::uintmax_t> places(title.cases), begins = {0};
  for (const fs::path& part : parts) {
    TableLines lines(part, title.cases);
    if (lines.next() && lines.line() != title.header) lines.refuse();
    while (lines.next()) places[lines.row()] = begins.back() + lines.begin();
    begins.push_back(begins.back() + lines.end());
  }
  const std::size_t found = places.size() - static_cast<std::size_t>(std::ranges::count(places, 0u));
  if (found != rows) return found;
  AtomicFile table(title.file);
  table.append(title.header + "\n");
  std::ifstream in;
  std::size_t opened = parts.size();
  std::string line;
  for (const std::uintmax_t place : places) {
    if (place == 0) continue;
    const auto file = static_cast<std::size_t>(std::ranges::upper_bound(begins, place) - begins.begin()) - 1;
    const auto offset = static_cast<std::streamoff>(place - begins[file]);
    if (std::exchange(opened, file) != file) in = std::ifstream(parts[file], std::ios::binary);
    if (in.tellg() != offset) in.seekg(offset);
    if (!std::getline(in, line)) throw IoError("read", parts[file], std::make_error_code(std::errc::io_error));
    table.append(line + "\n");
  }
  FileSet together;
  together.write(beside(title.file), json_text(title.about));
  together.take(std::move(table));
  together.commit();
  return found;
}

/// The number of shards that the tables of a folder are of; 0 without any. Throws InputError when they are not of one.
std::size_t shards_in(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    std::size_t index = 0, of = 0;
    if (std::sscanf(entry.path().filename().c_str(), "sweep.%zu_of_%zu.csv", &index, &of) != 2) continue;
    if (entry.path().filename() != table_name(Shard{index, of}) || of > kMostRuns) continue;
    if (count != 0 && of != count) {
      fail_in_file(entry.path(),
                   fmt::format("is one of {} shards, another one of {}; allowed: shards of one division", of, count));
    }
    count = of;
  }
  return count;
}

}  // namespace

std::vector<std::string> SweepPlan::columns() const {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : cases.axes()) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  columns.insert(columns.end(), metrics.begin(), metrics.end());
  for (const std::string& metric : bounded) columns.push_back(std::string(kToleranceOf) + metric);
  columns.emplace_back("state_hash");
  return columns;
}

std::vector<std::size_t> runs_to_check(const Cases& cases) {
  if (cases.size() <= kMostChecked || cases.sampling()) {
    std::vector<std::size_t> runs(std::min(cases.size(), kMostChecked));
    std::iota(runs.begin(), runs.end(), std::size_t{0});
    return runs;
  }
  std::set<std::size_t> runs;
  std::size_t stride = 1;
  for (std::size_t a = cases.axes().size(); a-- > 0;) {
    const std::size_t size = cases.axes()[a].size(), count = std::min(size, kMostChecked);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = count == 1 ? 0 : i * (size - 1) / (count - 1);
      runs.insert(place * stride);
      if (cases.axes().size() > 1) runs.insert(cases.size() - 1 - place * stride);
    }
    stride *= size;
  }
  return {runs.begin(), runs.end()};
}

SweepPlan plan_sweep(Cases cases, const JobOptions& jobs) {
  SweepPlan plan{std::move(cases)};
  const std::vector<std::size_t> runs = runs_to_check(plan.cases);
  std::vector<Point> points(runs.size());
  for_each_job(runs.size(), jobs, [&](std::size_t i) { points[i] = examine(plan, runs[i]); });
  Names metrics;
  std::map<std::string, std::string> plugins;
  Names files;                               // combinations of them
  std::vector<std::size_t> runs_with_files;  // the first one of each
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Point& point = points[i];
    add_names(metrics, point.metrics);
    append_new(plan.warnings, point.warnings);
    if (!point.origin.file.empty()) plugins.emplace(point.origin.file, point.origin.hash);
    if (!point.files.empty() && files.insert(point.files).second) runs_with_files.push_back(runs[i]);
  }
  const Json hashes = check_files(plan, runs_with_files, metrics);
  for (const Metric& metric : metrics_without_values(TrackingHandFields::kMostPlaces)) {
    if (!metrics.contains(metric.name)) continue;
    plan.metrics.push_back(metric.name);
    if (metric.bounded) plan.bounded.push_back(metric.name);
  }
  plan.content = content_of(plan, hashes, plugins);
  plan.definition = hash_text(hash_of(json_text(plan.content)));
  return plan;
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  const Shard part = options.shard.value_or(Shard{});
  SweepReport report;
  const std::vector<std::string> columns = plan.columns();
  const auto keep = [&](std::size_t run, std::string_view row) {
    const std::vector<std::string> cells = csv_cells(row);
    if (cells.size() != columns.size())
      throw InputError(fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
    return cells[1 + plan.cases.axes().size()] != kErrorOutcome &&
           (!options.keep_runs || fs::exists(run_folder(options, run) / "summary.json"));
  };
  Json about = {{"definition", plan.definition}, {"runs", plan.cases.size()}, {"shard", shard_text(part)}};
  about.update(plan.content);
  TableFile table({options.table(), fmt::format("{}", fmt::join(columns, ",")), about, plan.cases.size()},
                  options.resume ? TableFile::Keep(keep) : nullptr);
  report.resumed = table.count();
  std::vector<std::size_t> left;  // in the order of runs
  for (std::size_t place = part.index; place < plan.cases.size(); place += part.count)
    if (const std::size_t run = plan.cases.at(place); !table.rows()[run]) left.push_back(run);
  std::mutex mutex;  // of table and report
  for_each_job(left.size(), options.jobs, [&](std::size_t k) {
    const std::size_t run = left[k];
    std::string row, problem;
    try {
      const auto output = options.keep_runs ? std::optional(run_folder(options, run)) : std::nullopt;
      row = finished_row(plan, run, run_scenario(checked(plan.cases.load(run)), output, false));
    } catch (const IoError&) {
      throw;  // further runs could not be kept either; --resume goes on
    } catch (const std::exception& error) {
      problem = error.what();
    }
    const bool failed = row.empty();
    const std::lock_guard lock(mutex);
    table.add(run, failed ? error_row(plan, run) : row);
    if (failed && (!report.failed || run < *report.failed)) {
      report.failed = run;
      report.problem = problem;
    }
    if (!failed && options.added) options.added();
  });
  table.finish();
  return report;
}

void SweepCounts::add(std::size_t run, const std::string& outcome, bool is_expected) {
  const bool is_failure = outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[outcome];
  ++count.runs;
  count.expected += is_expected;
  failed += is_failure;
  if (is_failure || is_expected) return;
  if (unexpected++ == 0) first_unexpected = run;
}

std::vector<std::string> SweepTable::metrics() const {
  const auto first = columns.begin() + static_cast<std::ptrdiff_t>(place("steps")) + 1;
  return {first,
          std::find_if(first, columns.end() - 1, [](const auto& name) { return name.starts_with(kToleranceOf); })};
}

std::optional<double> SweepTable::number(const SweepRow& row, std::string_view column) const {
  const std::size_t at = place(column);
  return at < row.size() ? finite_number(row[at]) : std::nullopt;
}

SweepTable read_sweep(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table{
      .file = file, .about = description_of(beside(file)), .columns = {}, .rows = {}, .counts = {}, .kept = {}};
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  table.columns = csv_cells(line);
  const std::size_t outcome = table.place("outcome");
  if (table.columns[0] != "index" || table.columns.back() != "state_hash" || table.place("expected") != outcome + 1 ||
      table.place("steps") != outcome + 2)
    fail_in_file(file, "is not the table of the sweep that sweep.json describes");
  std::vector<Condition> all;
  for (const std::string& text : conditions) all.push_back(condition_of(text, table));
  while (std::getline(in, line)) {
    SweepRow row = csv_cells(line);
    const auto run = whole_number(row[0]);
    if (!run || row.size() != table.columns.size())
      fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    const bool is_expected = row[outcome + 1] == "true";
    table.counts.add(*run, row[outcome], is_expected);
    if (!std::ranges::all_of(all, [&row](const Condition& keeps) { return keeps(row); })) continue;
    table.kept.add(*run, row[outcome], is_expected);
    if (table.kept.runs <= SweepTable::kMostRows) table.rows.push_back(std::move(row));
  }
  if (table.kept.runs > SweepTable::kMostRows) table.rows.clear();
  return table;
}

// ---- The table while it grows

TableFile::TableFile(TableTitle title, const Keep& keep)
    : title_(std::move(title)),
      part_(part_of(title_.file)),
      about_part_(part_of(beside(title_.file))),
      out_(nullptr, std::fclose),
      has_(title_.cases) {
  std::error_code error;
  const std::size_t rows = rows_under_way(title_.file);
  if (keep) {
    resume(keep);
  } else if (rows > 0 && is_of_this_definition()) {
    fail_in_file(part_, fmt::format("holds {} finished runs of this sweep, which was interrupted; allowed: --resume to "
                                    "go on from there, another --out, or to begin anew without this file",
                                    rows));
  }
  const bool is_new = !keep || !fs::exists(part_, error) || fs::file_size(part_, error) == 0;
  if (is_new) {
    fs::remove(part_, error);  // first: a kill must not leave its rows beside another description
    write_file_atomically(about_part_, json_text(title_.about));
  }
  out_.reset(std::fopen(part_.c_str(), is_new ? "wbe" : "abe"));
  if (!out_) throw IoError("write", part_, {errno, std::generic_category()});
  std::setvbuf(out_.get(), nullptr, _IONBF, 0);  // so that a line is written at once
  if (is_new) append(title_.header + "\n");
}

/// True if the table under way, or else the finished one, has this definition.
bool TableFile::is_of_this_definition() const {
  std::error_code ignored;
  const std::string found = definition_in(fs::exists(part_, ignored) ? about_part_ : beside(title_.file));
  return title_.about.at("definition") == found;
}

/// Finds the rows that are there, and leaves the part without its last line if that is torn.
void TableFile::resume(const Keep& keep) {
  std::error_code error;
  const bool is_part = fs::exists(part_, error);
  if (!is_part && !fs::exists(title_.file, error)) return;
  if (!is_of_this_definition()) {
    fail_in_file(
        is_part ? part_ : title_.file,
        "is not the table of this sweep; --resume needs the same scenario, --set, --vary, --shard, named files, "
        "plugins and program; without --resume the sweep begins anew");
  }
  if (!is_part) {
    write_file_atomically(about_part_, json_text(title_.about));
    fs::copy_file(title_.file, part_, error);
    if (error) throw IoError("write", part_, error);
  }
  TableLines lines(part_, title_.cases);
  if (lines.next() && lines.line() != title_.header) lines.refuse();
  while (lines.next()) {
    const std::size_t i = lines.row();
    try {
      has_[i] = keep(i, lines.line());
    } catch (const InputError& refusal) {
      lines.refuse(refusal.problem());
    }
  }
  fs::resize_file(part_, lines.end(), error);
  if (error) throw IoError("write", part_, error);
}

std::size_t TableFile::rows_under_way(const fs::path& file) {
  std::size_t lines = 0;
  for (TableLines table(part_of(file), 0); table.next();) ++lines;
  return lines - std::min<std::size_t>(lines, 1);
}

void TableFile::append(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), out_.get()) != text.size())
    throw IoError("write", part_, {errno, std::generic_category()});
}

void TableFile::add(std::size_t i, std::string_view row) {
  append(std::string(row) + "\n");
  has_[i] = true;
}

void TableFile::finish() {
  out_.reset();
  if (put_in_order(title_, {part_}, count()) != count())  // another process has begun it anew
    throw IoError("read", part_, std::make_error_code(std::errc::io_error));
  std::error_code ignored;
  for (const fs::path& part : {part_, about_part_}) fs::remove(part, ignored);
}

std::string table_name(const std::optional<Shard>& shard) {
  return shard ? fmt::format("sweep.{}_of_{}.csv", shard->index, shard->count) : "sweep.csv";
}

bool join_shards(const fs::path& folder) {
  constexpr std::size_t kMostShown = 10;
  const std::size_t count = shards_in(folder);
  const fs::path whole = folder / table_name(std::nullopt);
  std::error_code ignored;
  std::vector<fs::path> shards;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < count; ++i) {
    shards.push_back(folder / table_name(Shard{i, count}));
    if (!fs::exists(shards.back(), ignored)) missing.push_back(shard_text({i, count}));
  }
  if (count == 0 || (!missing.empty() && fs::exists(whole, ignored))) return false;
  if (const std::size_t lack = missing.size(); lack > 0) {
    missing.resize(std::min(lack, kMostShown));
    throw InputError(fmt::format("{}: {} of {} shards missing: {}{}", folder.string(), lack, count,
                                 fmt::join(missing, ", "), lack > kMostShown ? ", ..." : ""));
  }
  TableTitle title{whole, "", read_json(beside(shards[0]))};
  const std::string definition = title.about.value("definition", "");
  for (const fs::path& shard : shards) {
    if (const std::string other = definition_in(beside(shard)); other != definition) {
      fail_in_file(shard,
                   fmt::format("is of another sweep than {}: definition {}, there {}; allowed: shards of one sweep",
                               shards[0].string(), other, definition));
    }
  }
  title.cases = std::min(title.about.value("runs", std::size_t{0}), kMostRuns);
  title.about["shard"] = shard_text({});
  TableLines first(shards[0], 0);
  first.next();
  title.header = first.line();
  if (const std::size_t found = put_in_order(title, shards, title.cases); found != title.cases) {
    throw InputError(fmt::format("{}: the shards have {} of {} rows; allowed: complete tables", folder.string(), found,
                                 title.cases));
  }
  return true;
}

}  // namespace hapbench
