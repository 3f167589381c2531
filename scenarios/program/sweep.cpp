#include "scenarios/program/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/join_shards.hpp"
#include "scenarios/batch/number_with_error.hpp"
#include "scenarios/batch/ranking.hpp"
#include "scenarios/batch/run_cost.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/batch/sampling.hpp"
#include "scenarios/batch/shard.hpp"
#include "scenarios/batch/sweep_columns.hpp"
#include "scenarios/batch/sweep_plan.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/shell_words.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/program_arguments.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/results_folder.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTimesFile = "sweep_timing.csv";

/// Returns the printed columns of a run: the varied fields, the outcome and the columns that the command `run` prints.
/// Adds a column for `metric` if no other column has this metric. If `costs` is not empty, it has the cost of each run,
/// and a column with the time of a step is added.
Columns<SweepRow> run_columns(const SweepTable& table, const std::string& metric, const std::vector<RunCost>& costs) {
  Columns<SweepRow> columns;
  // Begin with the varied fields. If several fields vary, add the index of the run.
  const bool single = table.fields() == 1;
  for (std::size_t c = single ? 1 : 0; c <= table.fields(); ++c) {
    std::string title = table.columns[c];
    if (const std::size_t dot = title.rfind('.'); !single && dot != std::string::npos) title.insert(dot + 1, "\n");
    const auto value = [c](const SweepRow& row) { return axis_cell(row[c]); };
    columns.add({{title, "unit of the field", table.columns[c], value, varied(only_printed())}});
  }
  const auto outcome = [&table](const SweepRow& row) { return table.outcome(row); };
  columns.add({{"outcome", "", "outcome", outcome, only_printed()}});
  // Add the columns that the command `run` prints, if the sweep has their metrics, and a column for `metric`.
  std::vector<RunHeading> headings;
  for (RunHeading heading : kRunHeadings) {
    heading.wide = heading.wide && heading.metric != metric;
    if (table.column_index(heading.metric) < table.columns.size()) headings.push_back(heading);
  }
  if (std::ranges::find(headings, metric, &RunHeading::metric) == headings.end())
    headings.push_back({metric.c_str(), metric.c_str(), 1.0, false});
  add_metrics(columns, headings, [&table](const SweepRow& row, const char* name) {
    return NumberWithError{table.number(row, name), table.tolerance(row, name)};
  });
  if (costs.empty()) return columns;
  const auto microseconds = [&costs](const SweepRow& row) {
    return significant(1e6 * costs[*whole_number(row[0])].step_s, 3);
  };
  columns.add({{"us per\nstep", "1", "seconds_per_step in microseconds", microseconds, only_printed()}});
  return columns;
}

using OutcomeCount = std::pair<const std::string, SweepCounts::Count>;

Columns<OutcomeCount> count_columns() {
  return {{"outcome", "", "outcome", &OutcomeCount::first, only_printed()},
          {"runs", "1", "of sweep: number of runs with this outcome",
           [](const OutcomeCount& c) { return c.second.runs; }, only_printed()},
          {"as expected", "1", "of sweep: number of the runs with this outcome that meet the scenario's expect",
           [](const OutcomeCount& c) { return c.second.expected; }, only_printed()}};
}

/// Largest numbers of printed runs: kMaxShown for a sweep of one field, kMaxListed for a sweep of several fields.
constexpr std::size_t kMaxShown = 100, kMaxListed = 20;

/// Returns the table of the runs, followed by the number of runs with each outcome. If several fields vary, the runs
/// are in ascending order of `metric`, and runs that failed come last.
std::string summary_text(const SweepTable& table, const std::string& metric, const std::vector<RunCost>& costs,
                         const Layout& layout) {
  std::vector<SweepRow> rows = table.rows;
  const bool single = table.fields() == 1;
  const std::size_t shown = std::min(rows.size(), single ? kMaxShown : kMaxListed);
  std::string text;
  if (!single) {
    std::ranges::stable_sort(rows, {}, [&](const SweepRow& row) {
      const bool failed = table.outcome(row) == kErrorOutcome || is_failure(table.outcome(row));
      return std::pair(failed, table.number(row, metric).value_or(std::numeric_limits<double>::infinity()));
    });
    text = fmt::format("{} of {} runs, smallest {} first\n\n", shown, rows.size(), metric);
  }
  if (shown < rows.size() && single) text = fmt::format("the first {} of {} runs\n\n", shown, rows.size());
  rows.resize(shown);
  if (shown > 0) text += run_columns(table, metric, costs).text(rows, layout) + "\n";
  text += count_columns().text(table.kept.outcomes, layout) + "\n";
  const auto knows = [&](const char* name) {
    return [&table, name](const SweepRow& row) { return table.number(row, name).has_value(); };
  };
  const auto is_empty = [&](const SweepRow& row) {
    return !is_failure(table.outcome(row)) && !knows("force_mean_in_contact_N")(row);
  };
  if (std::ranges::any_of(rows, knows("force_mean_in_contact_N")))
    text +=
        headings_legend(std::ranges::any_of(rows, is_empty), std::ranges::any_of(rows, knows("inside_max_m")), layout);
  return text + layout.wrapped(
                    "as expected: outcome and metrics agree with the scenario's field expect. The outcome completes "
                    "says nothing about vibration, which \"hapbench run\" diagnoses",
                    0);
}

/// Returns a cell as JSON if it is valid JSON, else as text; null for an empty cell.
Json json_of_cell(const std::string& cell) {
  if (cell.empty()) return Json();
  return Json::accept(cell) ? Json::parse(cell) : Json(cell);
}

Json summary_json(const SweepTable& table) {
  const SweepCounts& counts = table.kept;
  Json outcomes = Json::object();
  for (const auto& [outcome, count] : counts.outcomes) outcomes[outcome] = count.runs;
  std::size_t unexpected = 0;
  for (const auto& [outcome, runs] : counts.unexpected) unexpected += runs.size();
  Json json = {{"definition", table.about["definition"]},
               {"runs", counts.runs},
               {"outcomes", std::move(outcomes)},
               {"unexpected", unexpected},
               {"failed", counts.failed},
               {"file", table.file.string()}};
  if (counts.runs > SweepTable::kMaxRows) return json;
  Json& rows = json["rows"] = Json::array();
  for (const SweepRow& row : table.rows) {
    Json& added = rows.emplace_back(Json::object());
    for (std::size_t c = 0; c < row.size(); ++c) {
      const bool is_hash = c + 1 == row.size();  // a hash may look like a number
      added[table.columns[c]] = is_hash && !row[c].empty() ? Json(row[c]) : json_of_cell(row[c]);
    }
  }
  return json;
}

/// Values of the options of `sweep`.
struct SweepCommand : CommonOptions {
  std::string scenario, sample, points, metric, shard;
  std::vector<std::string> vary, where;
  std::uint64_t seed = 1, row = 0;
  bool resume = false, keep_runs = false, print = false, full = false, time = false;
};

constexpr std::size_t kMaxTimed = 1000;

constexpr const char* kNoScene =
    "sweep: no scenario is given; allowed: a scenario and --vary, or the folder of a "
    "finished sweep";

/// Throws the InputError of a sweep without --vary and --points. `scenario`: argument of the command, empty if it is
/// missing. Precondition: `scenario` is not the folder of a finished sweep, which needs neither option.
[[noreturn]] void fail_without_axes(const std::string& scenario) {
  if (scenario.empty()) throw InputError(kNoScene);
  throw InputError(
      fmt::format("sweep: got {} without --vary, and it is no folder of a finished sweep; allowed: with "
                  "--vary or --points, such as --vary rendering.stiffness_N_per_m=1e3:1e5:9:log",
                  shell_word(scenario)));
}

/// If an axis of --vary lists scenarios (kSceneAxis), returns these scenarios. Otherwise returns the scenario that the
/// command line names. Throws InputError if both or none are given.
std::vector<ScenarioText> scenes_of(const SweepCommand& command, const std::vector<Axis>& axes) {
  const auto axis = std::ranges::find(axes, kSceneAxis, &Axis::path);
  if (axis == axes.end()) {
    if (command.scenario.empty()) throw InputError(kNoScene);
    return {read_scenario_text(find_scenario(command.scenario))};
  }
  if (!command.scenario.empty() || axis->range)
    fail_in_option("--vary",
                   fmt::format("got \"{}\" as a {}; allowed: a list of scenarios, without the argument <scenario>",
                               kSceneAxis, axis->range ? "range" : "field together with a scenario"));
  std::vector<ScenarioText> scenes;
  for (const std::string& name : axis->values) scenes.push_back(read_scenario_text(find_scenario(name)));
  return scenes;
}

Cases cases_of(const SweepCommand& command) {
  std::vector<Axis> axes;
  std::optional<Sampling> sampling;
  if (!command.points.empty() && (!command.vary.empty() || !command.sample.empty()))
    fail_in(
        {.about_options = {"--points", "--vary", "--sample"}},
        "--points: cannot be combined with --vary or --sample; allowed: the file alone, which has fields and values");
  for (const std::string& text : command.vary) axes.push_back(parse_axis(text, !command.sample.empty()));
  if (!command.points.empty()) sampling = read_points(command.points, axes);
  if (!command.sample.empty()) sampling = parse_sampling(command.sample, command.seed);
  std::vector<ScenarioText> scenes = scenes_of(command, axes);
  return {std::move(scenes), command.overrides, std::move(axes), std::move(sampling)};
}

/// Prints the number of runs that failed or ended unexpectedly, and the first of these runs. Returns the exit status.
int verdict(const Cases& cases, const SweepReport& report, const SweepCounts& counts, ProgramContext& context) {
  const std::string scene = cases.scenes().front().file.string();
  const auto run_text = [&cases](std::size_t run) {
    return fmt::format("run {} ({})", run, fmt::join(cases.changes(run), ", "));
  };
  if (report.failed) {
    print_error(context, fmt::format("{}: {} of {} runs failed, the first: {}: {}", scene, counts.failed, counts.runs,
                                     run_text(*report.failed), one_line(report.problem)));
    return kInternalFault;
  }
  // A simulated failure, such as a tool that goes through the surface, is a result and no error of the command. It is
  // an error only if the scenario states expectations (field expect) that the run does not meet.
  std::vector<std::size_t> unmet, failures;
  std::vector<std::string> failures_by_outcome;  // "went_through 12"
  for (const auto& [outcome, runs] : counts.unexpected) {
    const std::size_t before = failures.size();
    for (const std::size_t run : runs) (states_expectations(cases, run) ? unmet : failures).push_back(run);
    if (failures.size() > before)
      failures_by_outcome.push_back(fmt::format("{} {}", outcome, failures.size() - before));
  }
  if (!failures.empty()) {
    print_note(context, fmt::format("{}: {} of {} runs failed ({}), the first: {}", scene, failures.size(), counts.runs,
                                    fmt::join(failures_by_outcome, ", "), run_text(std::ranges::min(failures))));
  }
  if (unmet.empty()) return kSuccess;
  print_note(context, fmt::format("{}: {} of {} runs did not meet the scenario's expect, the first: {}", scene,
                                  unmet.size(), counts.runs, run_text(std::ranges::min(unmet))));
  return kUnexpectedOutcome;
}

/// Prints the command that repeats the run of a row.
int print_row(const SweepCommand& command, const Cases& cases, ProgramContext& context) {
  if (command.row >= cases.size())
    fail_in_option("--row", fmt::format("got {}; allowed: 0 ... {}", command.row, cases.size() - 1));
  cases.load(command.row);  // throws if the scenario of this row is invalid
  const fs::path scene = fs::absolute(cases.scene(command.row).file).lexically_normal();
  std::vector<std::string> arguments = {context.program.string(), "run", scene.string()};
  for (const std::string& override : cases.overrides(command.row))
    arguments.insert(arguments.end(), {"--set", override});
  for (const LoadedModule& module : loaded_modules())
    arguments.insert(arguments.end(), {"--module", module.file.string()});
  if (ModulePermission::allows_all()) arguments.emplace_back("--allow-modules");
  print(context, command.output, shell_line(arguments) + "\n", Json{{"row", command.row}, {"command", arguments}});
  return kSuccess;
}

/// Prints the rows of a finished sweep that satisfy the conditions of --where. `resumed`: number of runs that an
/// interrupted earlier command had computed.
void print_sweep(const SweepCommand& command, const SweepTable& table, ProgramContext& context, std::size_t resumed = 0,
                 const std::vector<RunCost>& costs = {}) {
  const Layout layout = context.layout();
  const std::string metric = chosen_metric(table.metrics(), command.metric);
  for (const std::string& field : fields_without_effect(table))
    print_warnings(context, {field + " has no effect here: runs that differ only in it are equal to the last bit"});
  if (command.output.json) return print(context, command.output, "", summary_json(table));
  std::string text = summary_text(table, metric, costs, layout);
  if (resumed > 0) text += fmt::format("\n{} of the runs were taken from the interrupted sweep\n", resumed);
  text += fmt::format("\nresults in {}\n", table.file.string());
  if (!costs.empty())
    text += layout.wrapped(
        fmt::format(
            "processor times in {}: runs without observers and files, one at a time, smallest of {} repetitions",
            kTimesFile, kTimingRepetitions),
        0);
  if (!command.where.empty())
    text += fmt::format("{} of {} runs satisfy {}\n", table.kept.runs, table.counts.runs,
                        fmt::join(command.where, " and "));
  if (table.fields() > 1)
    text += fmt::format("\"hapbench plot {} --metric {}\" draws the results\n", shell_file(table.file.parent_path()),
                        shell_word(metric));
  print(context, command.output, text, {});
}

/// Cost of a run of a sweep.
struct TimedRun {
  std::size_t index;
  std::vector<std::string> values;  ///< values of the varied fields
  RunCost cost;
};

/// Returns the columns of sweep_timing.csv. `fields`: paths of the varied fields.
Columns<TimedRun> timing_columns(const std::vector<std::string>& fields) {
  Columns<TimedRun> columns = {{"index", "1", "index of the run, as in sweep.csv", &TimedRun::index}};
  for (std::size_t i = 0; i < fields.size(); ++i)
    columns.add(
        {{fields[i], "unit of the field", "value of the field", [i](const TimedRun& r) { return r.values[i]; }}});
  columns.add(
      {{"seconds_per_step", "s", "processor time of a step in a run without observers: smallest of five repetitions",
        [](const TimedRun& r) { return r.cost.step_s; }},
       {"spread_s", "s", "median of the repetitions minus the smallest repetition, of one step",
        [](const TimedRun& r) { return r.cost.spread_s; }},
       {"seconds_per_simulated_second", "s/s", "processor time per simulated second",
        [](const TimedRun& r) { return r.cost.per_simulated_second(); }},
       {"deadline_share", "1", "processor time of a step divided by 0.5 ms",
        [](const TimedRun& r) { return r.cost.deadline_share(); }},
       {"steps", "1",
        "steps of the measured run; fewer than the steps of the scenario if the run diverges or its task ends",
        [](const TimedRun& r) { return r.cost.steps; }}});
  return columns;
}

/// Measures the cost of each run of a sweep and writes sweep_timing.csv. Measures the runs in blocks of kTogether,
/// because each run keeps its simulation in memory until the end of the measurement.
std::vector<RunCost> timed_runs(const Cases& cases, const fs::path& directory, const JobOptions& jobs) {
  constexpr std::size_t kTogether = 32;
  std::vector<TimedRun> rows;
  std::vector<RunCost> costs;
  for (std::size_t first = 0; first < cases.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, cases.size() - first);
    for (const RunCost& cost : measure_cost(
             count, [&](std::size_t i) { return checked(cases.load(first + i)); }, jobs)) {
      rows.push_back({costs.size(), cases.values(costs.size()), cost});
      costs.push_back(cost);
    }
  }
  std::vector<std::string> fields;
  for (const Axis& axis : cases.axes()) fields.push_back(axis.path);
  FileSet files;
  timing_columns(fields).write(directory / kTimesFile, rows, files);
  files.commit();
  return costs;
}

/// Prints a finished sweep again. Throws InputError for options that would run something.
int reprint(const SweepCommand& command, ProgramContext& context) {
  const bool runs = !command.vary.empty() || !command.overrides.empty() || !command.sample.empty() ||
                    !command.points.empty() || !command.out.empty() || !command.shard.empty() || command.resume ||
                    command.keep_runs || command.print || command.full || command.time;
  if (runs) {
    throw InputError(fmt::format(
        "{}: holds a finished sweep, which is printed again; allowed with it: --where, --metric, --json, --quiet; "
        "--row and --print need the scenario and the options of the sweep instead",
        command.scenario));
  }
  const SweepTable table = read_sweep(fs::path(command.scenario) / "sweep.csv", command.where);
  if (!table.warning.empty()) print_warnings(context, {table.warning});
  print_sweep(command, table, context);
  return kSuccess;
}

int sweep(const SweepCommand& command, ProgramContext& context) {
  // If the argument is a folder with results, print the results. If it has all shards of a sweep, join them first.
  std::error_code ignored;
  if (fs::is_directory(command.scenario, ignored))
    if (join_shards(command.scenario) || fs::is_regular_file(fs::path(command.scenario) / "sweep.csv", ignored))
      return reprint(command, context);
  if (command.vary.empty() && command.points.empty()) fail_without_axes(command.scenario);
  if (!command.where.empty() && !command.shard.empty())
    fail_in_option(
        "--where",
        "got it for a shard; allowed: for a whole sweep, or in \"hapbench sweep FOLDER\", which joins the shards");
  if (command.time && !command.shard.empty())
    fail_in_option("--time", "got it for a shard; allowed: for a whole sweep");
  // Check all input before anything runs or is written.
  Cases cases = cases_of(command);
  if (command.time && cases.size() > kMaxTimed)
    fail_in_option("--time",
                   fmt::format("got {} runs; allowed: at most {}, because each run is repeated for 0.1 s or more",
                               cases.size(), kMaxTimed));
  if (command.print) return print_row(command, cases, context);
  SweepOptions options{
      .directory = results_directory(command.out, "sweep_" + cases.scenes().front().file.stem().string()),
      .jobs = job_options(command, "sweep", context),
      .resume = command.resume,
      .keep_runs = command.keep_runs};
  if (!command.shard.empty()) options.shard = parse_shard(command.shard);
  const SweepPlan plan = plan_sweep(std::move(cases), job_options(command, "checking", context),
                                    command.full ? RunLength::full : RunLength::until_failure);
  chosen_metric(plan.metrics, command.metric);            // throws if the metric does not exist
  print_warnings(context, first_few(plan.warnings, 20));  // there may be a warning for each run
  const FolderLock lock = locked_results(context, options.directory, options.table().filename().string(), "sweep");

  // Run the sweep, then print its table.
  const SweepReport report = run_sweep(plan, options);
  const SweepTable table = read_sweep(options.table(), command.where);
  std::error_code ignored_error;
  fs::remove(options.directory / kTimesFile, ignored_error);  // removes the times of an earlier sweep
  const bool is_timed = command.time && !report.failed;
  const std::vector<RunCost> costs =
      is_timed ? timed_runs(plan.cases, options.directory, job_options(command, "timing", context))
               : std::vector<RunCost>();
  print_sweep(command, table, context, report.resumed, costs);
  return verdict(plan.cases, report, table.counts, context);
}

}  // namespace

std::vector<DescribedTable> sweep_tables() {
  DescribedTable table{"sweep.csv", "written by sweep: one line per run", {}, count_columns().headings()};
  table.columns = {
      {"index", "1", "index of the run, from 0; one column per varied field follows, named by the field's path"},
      {"outcome", "", "outcome of the run; \"error\" if the run could not be computed"},
      {"expected", "", "true if the run meets the scenario's expect"},
      {"steps", "1", "number of time steps of the run"},
      {std::string(kEndedAt), "s", kEndedAtMeaning}};
  for (const Metric& metric : all_metrics()) table.columns.push_back({metric.name, metric.unit, metric.meaning});
  for (const Metric& metric : all_metrics())
    if (metric.bounded)
      table.columns.push_back({std::string(kToleranceOf) + metric.name, metric.unit,
                               "tolerance: largest error of the metric that its definition allows"});
  table.columns.push_back(
      {"state_hash", "",
       "hash over the bits of position, velocity and force of every time step: equal for identical runs"});
  return {table, timing_columns({}).described(kTimesFile,
                                              "written by sweep --time: one line per run; after index, one "
                                              "column per varied field")};
}

void add_sweep(CommandLine& line) {
  auto [command, options] =
      line.command("sweep", "Run a scenario once for each combination of field values, or for a random sample.", sweep,
                   "the same command with --resume continues");
  command.add(
      "scenario <scenario>", options.scenario,
      "scenario file or name of a bundled scenario; or the folder of a finished sweep (also of all its shards), to "
      "print it again");
  command.add(
      "--vary <field=values>", options.vary,
      "values of a field: a:b:n (n numbers from a to b), a:b:n:log (in equal ratios), or v,w,... (numbers, names or "
      "JSON); with --sample a:b or a:b:log; several --vary give all combinations",
      {.several = true});
  command.add("--sample <kind:n>", options.sample,
              "run n random points instead of all combinations: lhs:n (Latin hypercube) or random:n");
  command.add("--points <file.csv>", options.points,
              "run the points of a table instead: field paths in the first line, values in the others");
  command.add("--seed <n>", options.seed, "seed of the sample (default: 1)");
  command.needs("--seed", "--sample");
  command.add("--metric <name>", options.metric,
              "column of sweep.csv to show and to order runs by (default: " + std::string(kDefaultMetrics[0]) + ")");
  command.add(
      "--where <condition>", options.where,
      "print only runs that meet the condition, such as 'inside_max_m<3e-4'; one of < <= > >= = !=; repeatable, all "
      "must hold",
      {.several = true});
  add_common(command, options, "sweep_NAME");
  command.flag(
      "--resume", options.resume,
      "continue an interrupted sweep: repeat its command with --resume added; also repeats the runs that could not "
      "be computed");
  command.flag("--keep-runs", options.keep_runs, "also write the files of each run into OUT/runs/INDEX");
  command.flag("--full", options.full,
               "make all steps of runs that otherwise end early and have empty metrics (see Failed runs)");
  command.flag("--time", options.time,
               "also measure the processor time of each run, without metrics and files, one run at a time; writes "
               "sweep_timing.csv");
  command.add("--row <index>", options.row, "row of sweep.csv for --print, from 0");
  command.flag("--print", options.print,
               "print the \"hapbench run\" command that repeats one row, and run nothing: add --print and --row to the "
               "command of the sweep");
  command.needs("--row", "--print");
  command.needs("--print", "--row");
  command.add(
      "--shard <i/n>", options.shard,
      "run only rows i, i+n, i+2n, ... (i from 0), for several machines; \"hapbench sweep FOLDER\" joins the shards");
  command.footer(fmt::format(
      "Files: sweep.csv has one row per run: index, the varied fields, outcome, expected, steps, ended_at_s, all "
      "metrics, state_hash. A run that could not be computed has the outcome \"error\". Finished rows are kept in "
      "sweep.csv.part until the sweep ends.\n\n"
      "Printed: with one varied field, at most {} runs in the order of its values; with several fields or a sample, "
      "the {} runs with the smallest --metric, failed runs last. sweep.csv has all runs.\n\n"
      "Fields: rendering.algorithm=all tries every law; scenario=v,w,... varies the scenario, without <scenario>.\n\n"
      "Earlier results: a finished sweep in the folder is replaced. If the folder has finished rows of an interrupted "
      "sweep, a command without --resume is rejected with exit status 2, and the rows stay: use --resume or another "
      "--out.\n\n"
      "Failed runs: if a run diverges, passes through the surface or leaves it permanently, its metrics and recorders "
      "end at this moment (hapbench describe \"early end\"). Its row has the outcome, such as went_through, "
      "the time ended_at_s and empty metrics. Failed runs alone do not change the exit status.\n\n"
      "Exit status: 0 success, 1 a run could not be computed, 2 bad input, 3 a run does not meet the field expect, 130 "
      "stopped by Ctrl-C, after the current runs are finished. If --set or --vary changes a run, this run does not "
      "cause status 3, unless one of them sets expect.",
      kMaxShown, kMaxListed));
}

}  // namespace hapbench
