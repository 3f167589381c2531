#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "scenarios/batch/league.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/shell_words.hpp"
#include "scenarios/program/sweep_slurm.hpp"
#include "scenarios/program/sweep_status.hpp"
#include "scenarios/program/sweep_summary.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostJobs = 1024;

struct SweepCommand {
  std::string scenario;
  std::vector<std::string> vary;
  std::string sample;
  std::uint64_t seed = 1;
  std::string metric;
  std::string out;
  std::vector<std::string> overrides;
  std::int64_t jobs = 0;  ///< 0: one for each thread there is
  std::string shard;
  bool resume = false;
  bool keep_runs = false;
  std::uint64_t row = 0;
  bool print = false;
  std::string status;  ///< a directory; empty: no look at one, but a sweep
  SlurmOptions slurm;
  std::uint64_t slurm_shards = 0;
  OutputOptions output;
};

SweepPoints points_of(const SweepCommand& command) {
  const bool sampled = !command.sample.empty();
  std::vector<Axis> axes;
  for (const std::string& text : command.vary) {
    axes.push_back(sampled ? parse_sampled_axis(text) : parse_axis(text));
    Axis& axis = axes.back();
    if (axis.path == "rendering.algorithm" && axis.values == std::vector<std::string>{"all"}) {
      axis.values = all_algorithms();
    }
  }
  if (!sampled) return SweepPoints(std::move(axes));
  return SweepPoints(std::move(axes), parse_sampling(command.sample, command.seed));
}

SweepOptions sweep_options(const SweepCommand& command, const fs::path& scenario) {
  if (command.jobs < 0 || command.jobs > kMostJobs) {
    throw InputError(
        fmt::format("--jobs: got {}; allowed: 1 ... {}, or 0 for one per thread", command.jobs, kMostJobs));
  }
  SweepOptions options;
  options.directory =
      command.out.empty() ? fs::path("results") / "out" / ("sweep_" + scenario.stem().string()) : fs::path(command.out);
  options.jobs = command.jobs == 0 ? available_threads() : static_cast<std::size_t>(command.jobs);
  if (!command.shard.empty()) options.shard = parse_shard(command.shard);
  options.resume = command.resume;
  options.keep_runs = command.keep_runs;
  options.progress = !command.output.quiet;
  return options;
}

/// A sweep may give as many warnings as it has runs.
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
  return fmt::format("run {} ({})", run, fmt::join(plan.points.overrides(run), ", "));
}

/// Says what is wrong with the runs and returns the exit status.
int verdict(const SweepPlan& plan, const SweepReport& report) {
  const SweepCounts& counts = report.counts;
  if (report.failed) {
    print_error(fmt::format("{}: {} of {} runs failed, the first: {}: {}", plan.scenario.file.string(), counts.failed,
                            counts.runs, run_text(plan, report.failed->run), one_line(report.failed->problem)));
    return kInternalFault;
  }
  if (counts.unexpected > 0) {
    print_note(fmt::format("{}: {} of {} runs did not end as expected, the first: {}", plan.scenario.file.string(),
                           counts.unexpected, counts.runs, run_text(plan, *counts.first_unexpected)));
    return kUnexpectedOutcome;
  }
  return kSuccess;
}

/// The command that does again what a row of the table tells of.
int print_row(const SweepCommand& command, const fs::path& file) {
  const SweepPoints points = points_of(command);
  if (command.row >= points.size()) {
    throw InputError(fmt::format("--row: got {}; allowed: 0 ... {}", command.row, points.size() - 1));
  }
  std::vector<std::string> overrides = command.overrides;
  for (std::string& override : points.overrides(command.row)) overrides.push_back(std::move(override));
  load_scenario(file, overrides);  // which says what is wrong
  std::vector<std::string> words = {this_program().string(), "run", fs::absolute(file).lexically_normal().string()};
  for (const std::string& override : overrides) words.insert(words.end(), {"--set", override});
  for (std::string& word : plugin_words()) words.push_back(std::move(word));
  print(command.output, shell_line(words) + "\n", Json{{"row", command.row}, {"command", words}});
  return kSuccess;
}

/// The words of the command for one of its shards, up to shard, jobs and output.
std::vector<std::string> shard_command(const SweepCommand& command, const fs::path& file) {
  std::vector<std::string> words = {this_program().string(), "sweep", fs::absolute(file).lexically_normal().string()};
  for (const std::string& vary : command.vary) words.insert(words.end(), {"--vary", vary});
  for (const std::string& override : command.overrides) words.insert(words.end(), {"--set", override});
  if (!command.sample.empty()) {
    words.insert(words.end(), {"--sample", command.sample, "--seed", std::to_string(command.seed)});
  }
  if (command.keep_runs) words.emplace_back("--keep-runs");
  for (std::string& word : plugin_words()) words.push_back(std::move(word));
  return words;
}

int submit(const SweepCommand& command, const SweepPlan& plan, const SweepOptions& options) {
  SlurmOptions slurm = command.slurm;
  slurm.shards = command.slurm_shards;
  slurm.keep_runs = options.keep_runs;
  for (const std::string& value : {slurm.time, slurm.partition}) {
    constexpr const char* kUsual = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-:.,";
    if (value.find_first_not_of(kUsual) == std::string::npos) continue;
    throw InputError(fmt::format("--time, --partition: got \"{}\"; allowed: letters, digits and _-:.,", value));
  }
  if (slurm.shards > plan.points.size()) {
    throw InputError(fmt::format("--slurm: got {} shards of {} runs; allowed: 1 ... {}", slurm.shards,
                                 plan.points.size(), plan.points.size()));
  }
  const std::string text = submit_to_slurm(plan, slurm, options.directory, shard_command(command, plan.scenario.file));
  const auto jobs = jobs_of(options.directory);
  print(command.output, text,
        Json{{"array", jobs ? jobs->array : ""}, {"merge", jobs ? jobs->merge : ""}, {"shards", slurm.shards}});
  return kSuccess;
}

int sweep(const SweepCommand& command) {
  if (!command.status.empty()) {
    const SweepStatus status = sweep_status(command.status);
    print(command.output, status_text(status), status_json(status));
    return kSuccess;
  }
  if (command.scenario.empty() || command.vary.empty()) {
    throw InputError("sweep: got no scenario or no --vary; allowed: both, or --status FOLDER alone");
  }
  // All input is checked before anything runs or is written.
  const fs::path file = find_scenario(command.scenario);
  if (command.print) return print_row(command, file);
  const SweepOptions options = sweep_options(command, file);
  const SweepPlan plan =
      plan_sweep(read_scenario_text(file), command.overrides, points_of(command), options.jobs, options.progress);
  const std::string metric = chosen_metric(plan, command.metric);
  print_some_warnings(plan.warnings);
  require_writable_directory(options.directory);
  if (command.slurm_shards > 0) return submit(command, plan, options);

  const SweepReport report = run_sweep(plan, options);
  if (report.signal != 0) {
    print_note(fmt::format("stopped after {} of {} runs; the same command with --resume goes on from there",
                           report.done, options.part().size(plan.points.size())));
    return kStopped + report.signal;
  }
  if (command.output.json) {
    print(command.output, "", summary_json(plan, report));
  } else {
    const std::string picture = command.metric.empty() ? ""
                                                       : fmt::format("\"hapbench plot {} --metric {}\" draws it\n",
                                                                     options.directory.string(), metric);
    print(command.output, summary_text(plan, report, metric) + picture, {});
  }
  return verdict(plan, report);
}

void add_run_options(Command& command, SweepCommand& options) {
  command.add("--jobs", options.jobs, "runs at once; results do not depend on it (default: one per thread)");
  command.flag("--resume", options.resume, "go on where an interrupted sweep of the same definition was");
  command.flag("--keep-runs", options.keep_runs, "write the files of each run into runs/INDEX, too");
  CommandOption row = command.add("--row", options.row, "the index of a run, for --print");
  CommandOption print =
      command.flag("--print", options.print, "print the command that repeats the run of --row, and do nothing else");
  row.needs(print);
  print.needs(row);
}

void add_shard_options(Command& command, SweepCommand& options) {
  const CommandOption shard =
      command.add("--shard", options.shard, "i/n with 0 <= i < n: only the runs whose index leaves remainder i");
  CommandOption slurm =
      command.add("--slurm", options.slurm_shards,
                  "N: submit an array of N shards to Slurm, with a merge behind it; again: what failed or is missing");
  slurm.range(std::uint64_t{1}, std::uint64_t{kMostRuns}).excludes(shard);
  command.add("--time", options.slurm.time, "of a task, as sbatch takes it: 30, 2:00:00, 1-0").needs(slurm);
  command.add("--cpus", options.slurm.cpus, "of a task, as many runs at once (default: 1)").range(1, 1024).needs(slurm);
  command.add("--partition", options.slurm.partition, "of the cluster (default: its own)").needs(slurm);
  command.flag("--dry-run", options.slurm.dry_run, "write and print the scripts, submit nothing").needs(slurm);
  command.add("--status", options.status,
              "FOLDER: show which shards of the sweep in there are done, running, waiting, failed or missing");
}

}  // namespace

void add_sweep(CommandLine& line) {
  auto options = std::make_shared<SweepCommand>();
  Command command =
      line.command("sweep", "Run one scenario over a grid or a sample of values of any fields, in parallel");
  command.add("scenario", options->scenario, "scenario file, or name of a bundled scenario");
  command
      .add(
          "--vary", options->vary,
          "a field and its values: path=a:b:n (n numbers from a to b), path=a:b:n:log (in equal ratios) or "
          "path=v,w,... (numbers or texts; rendering.algorithm=all); several give all combinations, the last one varies fastest. With --sample "
          "path=a:b, path=a:b:log or path=v,w,...")
      .repeatable();
  const CommandOption sample =
      command.add("--sample", options->sample,
                  "runs at points of the box instead: lhs:N (Latin hypercube), sobol:N (shifted Sobol sequence, best "
                  "for powers of two) or random:N; listed values take equal shares");
  command.add("--seed", options->seed, "of the sample (default: 1)").needs(sample);
  command.add("--metric", options->metric,
              "what a sweep of two fields shows as table and map: a column of sweep.csv (default: " +
                  std::string(kDefaultMetrics[0]) + ")");
  command.add("--out", options->out, "directory of sweep.csv (default: results/out/sweep_NAME)");
  command.add("--set", options->overrides, "override a field of all runs: path=value").repeatable();
  add_run_options(command, *options);
  add_shard_options(command, *options);
  add_output_options(command, options->output);
  command.footer(
      "sweep.csv has a row for each run: index, the varied fields, outcome (\"error\" when it could not be computed), "
      "expected, steps, every metric, state_hash. Shards write sweep_shard_I_of_N.csv, which \"hapbench merge\" puts "
      "together. Ctrl-C stops after the runs in flight.\n"
      "Exit status: 0 success, 1 a run could not be computed, 2 bad input or usage, 3 a run did not end as expected, "
      "130 stopped by Ctrl-C.");
  command.runs([options] { return sweep(*options); });
}

}  // namespace hapbench
