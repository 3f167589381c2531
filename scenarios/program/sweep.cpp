#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "scenarios/cases/league.hpp"
#include "scenarios/cases/parallel_for.hpp"
#include "scenarios/cases/run_sweep.hpp"
#include "scenarios/cases/table_file.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/load_module.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::string shown_value(const std::string& text) {
  const auto number = finite_number(text);
  return number ? significant(*number, 6) : text;
}

bool has_failed(const SweepTable& table, const SweepRow& row) {
  return table.outcome(row) == kErrorOutcome || is_failure(table.outcome(row));
}

/// What a cell of the file holds, by its looks.
Cell cell_of_text(const std::string& text) {
  if (text.empty()) return {};
  if (text == "true" || text == "false") return text == "true";
  if (const auto count = whole_number(text)) return std::uint64_t{*count};
  if (const auto number = finite_number(text)) return *number;
  return text;
}

constexpr Column kOwnColumns[] = {
    {"index", "1", "number of the run, from 0; the varied fields follow, by their paths"},
    {"outcome", "", "how the run ended; \"error\" for one that could not be computed"},
    {"expected", "", "true when it ended as the scenario's expect says"},
    {"steps", "1", "rows of the run"},
    {"state_hash", "", "over the bits of position, velocity and force of every row: equal for equal runs"}};

/// What there is to say of a column of the file; `metrics`: all there are.
Column described(const std::string& name, const MetricList& metrics) {
  for (const Column& own : kOwnColumns)
    if (name == own.name) return own;
  const bool is_tolerance = name.starts_with(kToleranceOf);
  const Metric* metric = find_metric(metrics, is_tolerance ? name.substr(kToleranceOf.size()) : name);
  if (metric == nullptr) return {name.c_str(), "by name", "value of the field"};
  return {name.c_str(), metric->unit, is_tolerance ? "by how much the metric may be wrong" : metric->meaning};
}

Columns<SweepRow> file_columns(const std::vector<std::string>& names) {
  const MetricList metrics = metrics_without_values();
  Columns<SweepRow> columns;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool is_hash = c + 1 == names.size();  // which may look like a number
    const Column column = described(names[c], metrics);
    columns.add(column.name, column.unit, column.meaning, [c, is_hash](const SweepRow& row) {
      return is_hash && !row[c].empty() ? Cell(row[c]) : cell_of_text(row[c]);
    });
  }
  return columns;
}

/// What is printed of a run, with the headings that run and compare have.
Columns<SweepRow> run_columns(const SweepTable& table) {
  Columns<SweepRow> columns;
  const bool single = table.axes.size() == 1;
  for (std::size_t c = single ? 1 : 0; c <= table.axes.size(); ++c) {
    std::string title = table.columns[c];
    if (const std::size_t dot = title.rfind('.'); !single && dot != std::string::npos) title.insert(dot + 1, "\n");
    const bool sampled = table.sampled && c > 0;
    columns.print(title, "by name", table.columns[c],
                  [c, sampled](const SweepRow& row) { return sampled ? shown_value(row[c]) : row[c]; });
  }
  columns.print("outcome", "", "outcome", [&table](const SweepRow& row) { return table.outcome(row); });
  for (const RunHeading& heading : shown_headings()) {
    if (std::ranges::find(table.columns, heading.metric) == table.columns.end()) continue;
    columns.print(heading.title, "by name", heading.metric, [&table, heading](const SweepRow& row) {
      const auto value = table.number(row, heading.metric);
      return value ? short_text(*value, table.tolerance(row, heading.metric), heading.factor) : "-";
    });
  }
  return columns;
}

using OutcomeCount = std::pair<const std::string, SweepCounts::Count>;

Columns<OutcomeCount> count_columns() {
  Columns<OutcomeCount> columns;
  columns.print("outcome", "", "outcome", &OutcomeCount::first);
  columns.print("runs", "1", "of sweep: number of the runs with this outcome",
                [](const OutcomeCount& c) { return c.second.runs; });
  columns.print("as expected", "1", "of sweep: number of these that ended as the scenario's expect says",
                [](const OutcomeCount& c) { return c.second.expected; });
  return columns;
}

bool holds_texts(const Axis& axis) {
  return !std::ranges::all_of(axis.values, [](const auto& value) { return finite_number(value).has_value(); });
}

/// The metric over a grid of two fields, of which fields of texts go down; empty for other sweeps.
std::string grid_text(const SweepTable& table, const std::string& metric) {
  constexpr std::size_t kMostCells = 400;
  const std::vector<Axis>& axes = table.axes;
  if (axes.size() != 2 || table.sampled || axes[0].size() > kMostCells || axes[1].size() > kMostCells) return "";
  if (table.rows.size() != axes[0].size() * axes[1].size() || table.rows.size() > kMostCells) return "";
  const bool first_down = !holds_texts(axes[1]) || holds_texts(axes[0]);
  const Axis &down = axes[first_down ? 0 : 1], &across = axes[first_down ? 1 : 0];
  std::vector<Table::Column> columns = {{fmt::format("{} \\ {}", down.path, across.path), !holds_texts(down)}};
  for (std::size_t i = 0; i < across.size(); ++i) columns.push_back({shown_value(across.value(i))});
  Table shown(columns);
  for (std::size_t j = 0; j < down.size(); ++j) {
    std::vector<std::string> cells = {shown_value(down.value(j))};
    for (std::size_t i = 0; i < across.size(); ++i) {
      const SweepRow& row = table.rows[first_down ? j * across.size() + i : i * down.size() + j];
      const auto value = table.number(row, metric);
      const int digits = deserved_digits(value.value_or(0.0), table.tolerance(row, metric), 4);
      cells.push_back(has_failed(table, row) ? table.outcome(row) : significant(value, digits));
    }
    shown.add(std::move(cells));
  }
  return fmt::format("{}\n\n{}\n", metric, shown.text(prose_width()));
}

/// The rows with the least of the metric, failures last; for a single axis all rows.
std::string listed_text(const SweepTable& table, const std::string& metric) {
  constexpr std::size_t kMostShown = 100, kMostListed = 20;
  std::vector<SweepRow> rows = table.rows;
  const bool single = table.axes.size() == 1;
  if (rows.empty() || (single && rows.size() > kMostShown)) return "";
  const auto key = [&](const SweepRow& row) {
    const auto value = single ? finite_number(row[1]) : table.number(row, metric);
    return std::pair(has_failed(table, row), value.value_or(std::numeric_limits<double>::infinity()));
  };
  if (!single || table.sampled) std::ranges::stable_sort(rows, {}, key);
  if (single) return run_columns(table).table(rows).text() + "\n";
  rows.resize(std::min(kMostListed, rows.size()));
  return fmt::format("{} of {} runs, least {} first\n\n{}\n", rows.size(), table.rows.size(), metric,
                     run_columns(table).table(rows).text());
}

/// The counts of outcomes, and above them for a sweep of one field the runs (up to 100) with their main metrics, for a
/// grid of two fields (up to 400 cells) the metric as a table, else the 20 runs with the least of the metric.
std::string summary_text(const SweepTable& table, const std::string& metric) {
  std::string text = grid_text(table, metric);
  if (text.empty()) text = listed_text(table, metric);
  const std::vector<OutcomeCount> outcomes(table.kept.outcomes.begin(), table.kept.outcomes.end());
  return text + count_columns().table(outcomes).text();
}

/// The counts, and the rows that the table has.
Json summary_json(const SweepTable& table) {
  const SweepCounts& counts = table.kept;
  Json outcomes = Json::object();
  for (const auto& [outcome, count] : counts.outcomes) outcomes[outcome] = count.runs;
  Json json = {{"definition", table.definition},  {"runs", counts.runs},     {"outcomes", std::move(outcomes)},
               {"unexpected", counts.unexpected}, {"failed", counts.failed}, {"file", table.file.string()}};
  if (counts.runs > SweepTable::kMostRows) return json;
  const Columns<SweepRow> columns = file_columns(table.columns);
  Json& rows = json["rows"] = Json::array();
  for (const SweepRow& row : table.rows) {
    Json& added = rows.emplace_back(columns.json(row));
    for (std::size_t c = 1; c < table.outcome_place(); ++c)
      if (row[c].starts_with('{') || row[c].starts_with('[')) added[table.columns[c]] = parse_json(row[c]);
  }
  return json;
}

// ---- The command

struct SweepCommand : CommonOptions {
  std::string scenario;
  std::vector<std::string> vary;
  std::string sample, points, metric;
  std::uint64_t seed = 1;
  std::vector<std::string> where;
  std::string shard;
  bool resume = false, keep_runs = false, print = false;
  std::uint64_t row = 0;
};

/// The scenes that an axis names, or the one of the command line.
std::vector<ScenarioText> scenes_of(const SweepCommand& command, const std::vector<Axis>& axes) {
  const auto axis = std::ranges::find(axes, kSceneAxis, &Axis::path);
  if (axis == axes.end()) {
    if (command.scenario.empty())
      throw InputError("sweep: got no scenario or no --vary; allowed: both, or the folder of a finished sweep");
    return {read_scenario_text(find_scenario(command.scenario))};
  }
  if (!command.scenario.empty() || axis->range) {
    throw InputError(fmt::format("--vary: got \"{}\" as a {}; allowed: a list of scenarios, and none before it",
                                 kSceneAxis, axis->range ? "range" : "field beside a scenario"));
  }
  std::vector<ScenarioText> scenes;
  for (const std::string& name : axis->values) scenes.push_back(read_scenario_text(find_scenario(name)));
  return scenes;
}

Cases cases_of(const SweepCommand& command) {
  if (!command.points.empty()) {
    if (!command.vary.empty() || !command.sample.empty())
      throw InputError(
          "--points: got it beside --vary or --sample; allowed: the file alone, which has fields and values");
    PointTable points = read_points(command.points);
    std::vector<ScenarioText> scenes = scenes_of(command, points.axes);
    return {std::move(scenes), command.overrides, std::move(points)};
  }
  std::vector<Axis> axes;
  for (const std::string& text : command.vary) axes.push_back(parse_axis(text, !command.sample.empty()));
  std::vector<ScenarioText> scenes = scenes_of(command, axes);
  if (command.sample.empty()) return {std::move(scenes), command.overrides, std::move(axes)};
  return {std::move(scenes), command.overrides, std::move(axes), parse_sampling(command.sample, command.seed)};
}

SweepOptions sweep_options(const SweepCommand& command, const fs::path& scenario) {
  SweepOptions options;
  options.directory = results_directory(command.out, "sweep_" + scenario.stem().string());
  options.jobs = job_options(command, "").threads;
  if (!command.shard.empty()) options.shard = parse_shard(command.shard);
  options.resume = command.resume;
  options.keep_runs = command.keep_runs;
  options.progress = !command.output.quiet;
  return options;
}

std::string run_text(const SweepPlan& plan, std::size_t run) {
  return fmt::format("run {} ({})", run, fmt::join(plan.cases.changes(run), ", "));
}

/// Reports runs that failed or ended unexpectedly and returns the exit status.
int verdict(const SweepPlan& plan, const SweepReport& report, const SweepCounts& counts) {
  const std::string scene = plan.cases.scenes().front().file.string();
  if (report.failed) {
    print_error(fmt::format("{}: {} of {} runs failed, the first: {}: {}", scene, counts.failed, counts.runs,
                            run_text(plan, report.failed->run), one_line(report.failed->problem)));
    return kInternalFault;
  }
  if (counts.unexpected > 0) {
    print_note(fmt::format("{}: {} of {} runs did not end as expected, the first: {}", scene, counts.unexpected,
                           counts.runs, run_text(plan, *counts.first_unexpected)));
    return kUnexpectedOutcome;
  }
  return kSuccess;
}

/// Prints the command that repeats the run of a row.
int print_row(const SweepCommand& command, const Cases& cases) {
  if (command.row >= cases.size())
    throw InputError(fmt::format("--row: got {}; allowed: 0 ... {}", command.row, cases.size() - 1));
  cases.load(command.row);  // throws if the row's scenario is wrong
  const fs::path scene = fs::absolute(cases.scene(command.row).file).lexically_normal();
  std::vector<std::string> words = {this_program().string(), "run", scene.string()};
  for (const std::string& override : cases.overrides(command.row)) words.insert(words.end(), {"--set", override});
  for (const LoadedLaw& law : loaded_laws()) words.insert(words.end(), {"--module", law.file.string()});
  print(command.output, shell_line(words) + "\n", Json{{"row", command.row}, {"command", words}});
  return kSuccess;
}

/// Prints the rows that a finished sweep has, as far as they keep the conditions of --where; `resumed`: how many were
/// there before.
void print_sweep(const SweepCommand& command, const SweepTable& table, std::size_t resumed = 0) {
  const std::string metric = chosen_metric(table.metrics(), command.metric);
  if (command.output.json) return print(command.output, "", summary_json(table));
  std::string text = summary_text(table, metric);
  if (resumed > 0) text += fmt::format("\n{} of the runs were done before\n", resumed);
  text += fmt::format("\nresults in {}\n", table.file.string());
  if (!command.where.empty())
    text += fmt::format("{} of {} runs have {}\n", table.kept.runs, table.cases, fmt::join(command.where, " and "));
  const bool sampled = table.sampled && table.axes.size() > 1;
  if (sampled || !command.metric.empty()) {
    text += fmt::format("\"hapbench plot {} --metric {}\" draws it{}\n", table.file.parent_path().string(), metric,
                        sampled ? " and tells how much each field matters" : "");
  }
  print(command.output, text, {});
}

/// Prints the sweep of a folder, without a run.
int reprint(const SweepCommand& command) {
  const bool runs = !command.vary.empty() || !command.overrides.empty() || !command.sample.empty() ||
                    !command.points.empty() || !command.out.empty() || !command.shard.empty() || command.resume ||
                    command.keep_runs || command.print;
  if (runs) {
    throw InputError(fmt::format(
        "{}: holds a finished sweep, which is printed again; allowed beside it: --where, --metric, --json, --quiet",
        command.scenario));
  }
  print_sweep(command, read_sweep(fs::path(command.scenario) / "sweep.csv", command.where));
  return kSuccess;
}

/// Refuses to begin anew, without --resume, where the finished runs of the same sweep would be lost, and tells when
/// those of another are.
void check_table_under_way(const SweepPlan& plan, const SweepOptions& options) {
  const fs::path table = table_of(options);
  const std::size_t rows = TableFile::rows_under_way(table);
  const fs::path file = table.string() + ".part";
  if (options.resume || rows == 0) return;
  if (TableFile::is_of(table, plan.definition)) {
    fail_in_file(file,
                 fmt::format("holds {} finished runs of this sweep, which was interrupted; allowed: --resume to go on "
                             "from there, another --out, or to begin anew without this file",
                             rows));
  }
  print_note(
      fmt::format("{}: {} finished runs of another sweep, which was interrupted, are discarded", file.string(), rows));
}

int sweep(const SweepCommand& command) {
  std::error_code ignored;
  if (fs::is_directory(command.scenario, ignored))
    if (join_shards(command.scenario) || fs::is_regular_file(fs::path(command.scenario) / "sweep.csv", ignored))
      return reprint(command);
  if (command.vary.empty() && command.points.empty())
    throw InputError("sweep: got no scenario or no --vary; allowed: both, or the folder of a finished sweep");
  if (!command.where.empty() && !command.shard.empty())
    throw InputError(
        "--where: got it for a shard; allowed: for a whole sweep, or \"hapbench sweep FOLDER\" of the joined one");
  // All input is checked before anything runs or is written.
  Cases cases = cases_of(command);
  if (command.print) return print_row(command, cases);
  const SweepOptions options = sweep_options(command, cases.scenes().front().file);
  const SweepPlan plan = plan_sweep(std::move(cases), options.jobs, options.progress);
  chosen_metric(plan.metrics, command.metric);   // throws if there is none of that name
  print_warnings(first_few(plan.warnings, 20));  // there may be as many as runs
  require_writable_directory(options.directory);
  check_table_under_way(plan, options);

  const SweepReport report = run_sweep(plan, options);
  if (report.signal != 0) {
    print_note(fmt::format("stopped after {} of {} runs; the same command with --resume continues", report.done,
                           options.part().size(plan.cases.size())));
    return kStopped + report.signal;
  }
  const SweepTable table = read_sweep(table_of(options), command.where);
  print_sweep(command, table, report.resumed);
  return verdict(plan, report, table.counts);
}

}  // namespace

std::vector<DescribedTable> sweep_tables() {
  const MetricList metrics = metrics_without_values();
  std::vector<std::string> names = leading_columns({});
  for (const Metric& metric : metrics) names.push_back(metric.name);
  for (const Metric& metric : metrics)
    if (metric.bounded) names.push_back(std::string(kToleranceOf) + metric.name);
  names.emplace_back("state_hash");
  DescribedTable table = file_columns(names).described("sweep.csv", "of sweep: one line per run");
  table.headings = count_columns().headings();
  return {table};
}

void add_sweep(CommandLine& line) {
  auto [command, options] =
      line.command("sweep", "Run one scenario over a grid or a sample of values of any fields, in parallel", sweep);
  command.add(
      "scenario", options.scenario,
      "scenario file, or name of a bundled scenario; or the folder of a finished sweep, which is printed again");
  command.add(
      "--vary", options.vary,
      "a field and its values: path=a:b:n (n numbers from a to b), path=a:b:n:log (in equal ratios) or path=v,w,... "
      "(numbers, names or JSON; rendering.algorithm=all; scenario=v,w in place of SCENARIO). Several give all "
      "combinations; the last one varies fastest. With --sample: path=a:b, path=a:b:log or path=v,w,...",
      {.several = true});
  command.add("--sample", options.sample,
              "run a sample of points instead of all combinations: lhs:N (Latin hypercube) or random:N; listed values "
              "take equal shares");
  command.add(
      "--points", options.points,
      "run the points of a CSV file instead: fields' paths in the first line, their values in each further one");
  command.add("--seed", options.seed, "seed of the sample (default: 1)");
  command.needs("--seed", "--sample");
  command.add("--metric", options.metric,
              "the column of sweep.csv that is shown, by which runs are ordered (default: " +
                  std::string(kDefaultMetrics[0]) + ")");
  command.add("--where", options.where,
              "print only the runs with this: a column of sweep.csv, one of < <= > >= = !=, and a number or a text, as "
              "'inside_max_m<3e-4'; several must all hold",
              {.several = true});
  add_common(command, options, "sweep_NAME");
  command.flag("--resume", options.resume,
               "continue an interrupted sweep of the same definition, and try again what failed");
  command.flag("--keep-runs", options.keep_runs, "also write the files of each run, into runs/INDEX");
  command.add("--row", options.row, "index of the run for --print");
  command.flag("--print", options.print, "only print the command that repeats the run of --row");
  command.needs("--row", "--print");
  command.needs("--print", "--row");
  command.add("--shard", options.shard, "i/n with 0 <= i < n: do only every n-th run, from the i-th on");
  command.footer(
      "sweep.csv has a row for each run: index, the varied fields, outcome (\"error\" when it could not be computed), "
      "expected, steps, every metric, state_hash. \"hapbench sweep FOLDER\" prints it again, without a run. Shards write "
      "sweep.I_of_N.csv, and the same joins them. "
      "Ctrl-C stops after the runs that are under way.\n"
      "Exit status: 0 success, 1 a run could not be computed, 2 bad input or usage, 3 a run did not end as expected, "
      "130 stopped by Ctrl-C.");
}

}  // namespace hapbench
