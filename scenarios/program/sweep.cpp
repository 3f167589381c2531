#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "scenarios/batch/league.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/sweep.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostJobs = 1024;

struct SweepCommand {
  std::string scenario;
  std::vector<std::string> vary;
  std::string sample;
  std::string points;
  std::uint64_t seed = 1;
  std::string metric;
  std::vector<std::string> where;
  std::string out;
  std::vector<std::string> overrides;
  std::int64_t jobs = 0;  ///< 0: one per thread of the machine
  std::string shard;
  bool resume = false;
  bool keep_runs = false;
  std::uint64_t row = 0;
  bool print = false;
  OutputOptions output;
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
  if (command.jobs < 0 || command.jobs > kMostJobs) {
    throw InputError(
        fmt::format("--jobs: got {}; allowed: 1 ... {}, or 0 for one per thread", command.jobs, kMostJobs));
  }
  SweepOptions options;
  options.directory = results_directory(command.out, "sweep_" + scenario.stem().string());
  options.jobs = command.jobs == 0 ? available_threads() : static_cast<std::size_t>(command.jobs);
  if (!command.shard.empty()) options.shard = parse_shard(command.shard);
  options.resume = command.resume;
  options.keep_runs = command.keep_runs;
  options.progress = !command.output.quiet;
  return options;
}

/// Prints the first warnings: a sweep may give as many as it has runs.
void print_some_warnings(std::vector<std::string> warnings) {
  constexpr std::size_t kMost = 20;
  const std::size_t count = warnings.size();
  if (count > kMost) {
    warnings.resize(kMost);
    warnings.push_back(fmt::format("{} more like these", count - kMost));
  }
  print_warnings(warnings);
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
  std::ranges::copy(plugin_words(), std::back_inserter(words));
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

}  // namespace

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

namespace {

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
  chosen_metric(plan.metrics, command.metric);  // throws if there is none of that name
  print_some_warnings(plan.warnings);
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

void add_run_options(Command& command, SweepCommand& options) {
  command.add("--jobs", options.jobs, "runs at once; results do not depend on it (default: one per thread)");
  command.flag("--resume", options.resume,
               "continue an interrupted sweep of the same definition, and try again what failed");
  command.flag("--keep-runs", options.keep_runs, "also write the files of each run, into runs/INDEX");
  command.add("--row", options.row, "index of the run for --print");
  command.flag("--print", options.print, "only print the command that repeats the run of --row");
  command.needs("--row", "--print");
  command.needs("--print", "--row");
}

}  // namespace

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
  command.add("--out", options.out, "directory of sweep.csv (default: results/out/sweep_NAME)");
  add_overrides(command, options.overrides, "override a field of all runs: path=value");
  add_run_options(command, options);
  command.add("--shard", options.shard, "i/n with 0 <= i < n: do only every n-th run, from the i-th on");
  add_output_options(command, options.output);
  command.footer(
      "sweep.csv has a row for each run: index, the varied fields, outcome (\"error\" when it could not be computed), "
      "expected, steps, every metric, state_hash. \"hapbench sweep FOLDER\" prints it again, without a run. Shards write "
      "sweep.I_of_N.csv, and the same joins them. "
      "Ctrl-C stops after the runs that are under way.\n"
      "Exit status: 0 success, 1 a run could not be computed, 2 bad input or usage, 3 a run did not end as expected, "
      "130 stopped by Ctrl-C.");
}

}  // namespace hapbench
