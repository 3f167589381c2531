#include "scenarios/cases/run_sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <utility>

#include "algorithms/registry.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/provenance.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/cases/parallel_for.hpp"
#include "scenarios/cases/table_file.hpp"
#include "scenarios/format/descriptions.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/format/writer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

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
    hashes.push_back(with_file(loaded, [&] { return scenario_hash(loaded.scenario, loaded.files); }));
  }
  return hashes;
}

/// The values of an axis; only the ends of a range that has very many.
Json axis_content(const Axis& axis, bool of_a_file) {
  constexpr std::size_t kMostListed = 10'000;
  if (of_a_file) return {{"path", axis.path}};
  if (!axis.range || (axis.steps > 0 && axis.steps <= kMostListed)) {
    Json values = Json::array();
    for (std::size_t i = 0; i < axis.size(); ++i) values.push_back(axis.value(i));
    Json content = {{"path", axis.path}, {"values", std::move(values)}};
    for (const Axis::Along& along : axis.along)
      content["along"].push_back({{"set", along.overrides}, {"metrics_every_rows", along.stride}});
    return content;
  }
  Json content = {{"path", axis.path},
                  {"range", {axis.range->from, axis.range->to}},
                  {"scale", axis.range->logarithmic ? "log" : "linear"}};
  if (axis.steps > 0) content["count"] = axis.steps;
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
  const bool of_a_file = sampling && sampling->method == SamplingMethod::points;
  Json vary = Json::array();
  for (const Axis& axis : plan.cases.axes()) vary.push_back(axis_content(axis, of_a_file));
  Json content;
  if (scenes.size() == 1) content["scenario"] = scenes[0].json;
  if (scenes.size() > 1)
    for (const ScenarioText& scene : scenes) content["scenarios"].push_back(scene.json);
  content["set"] = plan.cases.sets();
  content["vary"] = std::move(vary);
  if (sampling) content["sample"] = {{"method", sampling_name(sampling->method)}, {"runs", sampling->count}};
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
  auto next = metrics.begin();  // the columns are in the same order, but some runs have more metrics than others
  for (const std::string& name : plan.metrics) {
    const bool is_it = next != metrics.end() && next->name == name;
    cells.push_back(is_it ? cell_text(next->value) : "");
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
    cells.push_back(tolerance ? cell_text(*tolerance) : "");
  }
  cells.push_back(hash_text(summary.state_hash));
  return line_of(plan, run, cells);
}

/// Whether the row of an earlier sweep stays. Throws InputError when it has not so many cells.
bool stays(const SweepPlan& plan, const SweepOptions& options, std::size_t run, std::string_view row,
           std::size_t columns) {
  const std::vector<std::string> cells = csv_cells(row);
  if (cells.size() != columns)
    throw InputError(fmt::format("got the row \"{}\"; allowed: rows of this sweep", row.substr(0, 60)));
  return cells[1 + plan.cases.axes().size()] != kErrorOutcome &&
         (!options.keep_runs || fs::exists(run_folder(options, run) / "summary.json"));
}

struct Sign {
  std::string_view text;
  bool (*holds)(double a, double b);
};

/// Longer ones first.
constexpr Sign kSigns[] = {
    {"<=", [](double a, double b) { return a <= b; }}, {">=", [](double a, double b) { return a >= b; }},
    {"!=", [](double a, double b) { return a != b; }}, {"<", [](double a, double b) { return a < b; }},
    {">", [](double a, double b) { return a > b; }},   {"=", [](double a, double b) { return a == b; }}};

/// Whether a row keeps a condition.
using Condition = std::function<bool(const SweepRow& row)>;

Condition condition_of(const std::string& text, const std::vector<std::string>& columns) {
  const std::size_t end = std::min(text.find_first_of("<>=!"), text.size());
  const std::string name = text.substr(0, end), rest = text.substr(end);
  const auto* sign = std::ranges::find_if(kSigns, [&](const Sign& s) { return rest.starts_with(s.text); });
  const std::string value = sign == std::end(kSigns) ? "" : rest.substr(sign->text.size());
  const auto number = finite_number(value);
  if (value.empty() || (!number && sign->text != "=" && sign->text != "!=")) {
    throw InputError(fmt::format(
        "--where: got \"{}\"; allowed: a column of sweep.csv, one of < <= > >= = !=, and a number (a text with = and !=), "
        "as inside_max_m<3e-4 or outcome=completes",
        text));
  }
  require_valid_name("--where: got", name, columns);
  const auto column = static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin());
  return [=](const SweepRow& row) {
    if (!number) return (row[column] == value) == (sign->text == "=");
    const auto found = finite_number(row[column]);
    return found && sign->holds(*found, *number);
  };
}

/// The axis that sweep.json describes.
Axis axis_of(const Json& json) {
  Axis axis{.path = json.at("path")};
  if (json.contains("values")) {
    axis.values = json.at("values").get<std::vector<std::string>>();
  } else if (json.contains("range")) {
    axis.range = Range{json.at("range").at(0), json.at("range").at(1), json.at("scale") == "log"};
    axis.steps = json.value("count", std::size_t{0});
  }
  return axis;
}

/// The table without its rows.
SweepTable described_table(const fs::path& file) {
  const fs::path about = fs::path(file).replace_extension(".json");
  try {
    const Json json = parse_json(read_text_file(about, kLargestJsonFile));
    SweepTable table;
    table.file = file;
    table.definition = json.at("definition");
    for (const Json& axis : json.at("vary")) table.axes.push_back(axis_of(axis));
    table.sampled = json.contains("sample");
    table.cases = json.at("runs");
    return table;
  } catch (const Json::exception&) {
    fail_in_file(about, "is not the description of a sweep");
  } catch (const InputError& error) {
    rethrow_with_file(error, about);
  }
}

/// Whether the columns are those of a sweep of these fields.
bool has_columns_of_sweep(const SweepTable& table) {
  const std::vector<std::string> first = leading_columns(table.axes);
  return table.columns.size() > first.size() && table.columns.back() == "state_hash" &&
         std::equal(first.begin(), first.end(), table.columns.begin());
}

}  // namespace

std::vector<std::string> SweepPlan::columns() const {
  std::vector<std::string> columns = leading_columns(cases.axes());
  columns.insert(columns.end(), metrics.begin(), metrics.end());
  for (const std::string& metric : bounded) columns.push_back(std::string(kToleranceOf) + metric);
  columns.emplace_back("state_hash");
  return columns;
}

Json SweepPlan::description(const Shard& shard) const {
  Json json = {{"definition", definition}, {"runs", cases.size()}, {"shard", shard_text(shard)}};
  json.update(content);
  return json;
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

SweepPlan plan_sweep(Cases cases, std::size_t jobs, bool progress) {
  SweepPlan plan{
      .cases = std::move(cases), .warnings = {}, .metrics = {}, .bounded = {}, .content = {}, .definition = ""};
  const std::vector<std::size_t> runs = runs_to_check(plan.cases);
  Names metrics;
  std::map<std::string, std::string> plugins;
  std::vector<Point> points(runs.size());
  for_each_job(runs.size(), {static_cast<unsigned>(jobs), progress ? "checking" : ""},
               [&](std::size_t i) { points[i] = examine(plan, runs[i]); });
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

fs::path table_of(const SweepOptions& options) {
  return options.directory / table_name(options.shard);
}

SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options) {
  const Shard part = options.part();
  SweepReport report;
  const std::vector<std::string> columns = plan.columns();
  const auto keep = [&](std::size_t run, std::string_view text) {
    return stays(plan, options, run, text, columns.size());
  };
  TableFile table(
      {table_of(options), fmt::format("{}", fmt::join(columns, ",")), plan.description(part), plan.cases.size()},
      options.resume ? TableFile::Keep(keep) : nullptr);
  report.resumed = table.count();
  const std::size_t size = part.size(plan.cases.size());
  ProgressBar bar("sweep", size, options.progress);
  bar.start_at(report.resumed);
  std::vector<std::size_t> left;  // in the order of runs
  for (std::size_t place = part.index; place < plan.cases.size(); place += part.count)
    if (const std::size_t run = plan.cases.at(place); !table.rows()[run]) left.push_back(run);
  std::mutex mutex;  // of table and report
  const auto work = [&](std::size_t k) {
    const std::size_t run = left[k];
    std::string row;
    std::optional<FailedRun> failed;
    try {
      const auto output = options.keep_runs ? std::optional(run_folder(options, run)) : std::nullopt;
      row = finished_row(plan, run, run_scenario(checked(plan.cases.load(run)), output, false));
    } catch (const IoError&) {
      throw;  // further runs could not be kept either; --resume goes on
    } catch (const std::exception& error) {
      row = error_row(plan, run);
      failed = FailedRun{run, error.what()};
    }
    const std::lock_guard lock(mutex);
    table.add(run, row);
    if (!failed) {
      if (options.added) options.added();
      bar.show(table.count(), true);
    } else if (!report.failed || run < report.failed->run) {
      report.failed = failed;
    }
  };
  try {
    for_each_job(left.size(), {static_cast<unsigned>(options.jobs), ""}, work);
  } catch (const Stopped&) {
    // It can be resumed.
  }
  report.done = table.count();
  if (report.done < size)
    report.signal = StopSignal::received();
  else
    table.finish();
  return report;
}

std::vector<std::string> leading_columns(const std::vector<Axis>& axes) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : axes) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  return columns;
}

void SweepCounts::add(std::size_t run, const std::string& outcome, bool is_expected) {
  const bool is_failure = outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[outcome];
  ++count.runs;
  if (is_expected) ++count.expected;
  if (is_failure) ++failed;
  if (is_failure || is_expected) return;
  ++unexpected;
  if (!first_unexpected) first_unexpected = run;
}

std::vector<std::string> SweepTable::metrics() const {
  const auto first = columns.begin() + static_cast<std::ptrdiff_t>(outcome_place()) + 3;
  return {first,
          std::find_if(first, columns.end() - 1, [](const auto& name) { return name.starts_with(kToleranceOf); })};
}

std::optional<double> SweepTable::number(const SweepRow& row, std::string_view column) const {
  const auto place = static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
  return place < row.size() ? finite_number(row[place]) : std::nullopt;
}

std::optional<double> SweepTable::tolerance(const SweepRow& row, std::string_view metric) const {
  return number(row, std::string(kToleranceOf) + std::string(metric));
}

SweepTable read_sweep(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table = described_table(file);
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  table.columns = csv_cells(line);
  if (!has_columns_of_sweep(table)) fail_in_file(file, "is not the table of the sweep that sweep.json describes");
  std::vector<Condition> all;
  for (const std::string& text : conditions) all.push_back(condition_of(text, table.columns));
  while (std::getline(in, line)) {
    SweepRow row = csv_cells(line);
    const auto run = whole_number(row[0]);
    if (!run || row.size() != table.columns.size())
      fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    const std::string& outcome = table.outcome(row);
    const bool is_expected = row[table.outcome_place() + 1] == "true";
    table.counts.add(*run, outcome, is_expected);
    if (!std::ranges::all_of(all, [&row](const Condition& keeps) { return keeps(row); })) continue;
    table.kept.add(*run, outcome, is_expected);
    if (table.kept.runs <= SweepTable::kMostRows) table.rows.push_back(std::move(row));
  }
  if (table.kept.runs > SweepTable::kMostRows) table.rows.clear();
  return table;
}

}  // namespace hapbench
