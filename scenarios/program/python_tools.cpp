#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/slurm.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

/// Commands that draw, and the suite: they pass their options on to Python, which reads the result files.
namespace hapbench {
namespace {

constexpr const char* kPictures = "hapbench_pictures";

struct PictureOptions {
  std::vector<std::string> runs;
  std::string quantities;
  std::string metric;
  std::vector<std::string> where;
  std::string from;
  std::string to;
  std::string out;
  bool no_sketch = false;
  bool quiet = false;
};

/// The command line of a Python tool.
class ToolCommand {
 public:
  ToolCommand(const char* package, const std::string& tool, bool quiet)
      : words_{(installed_folder("scripts/python") / "launch").string(), package, tool} {
    if (quiet) words_.emplace_back("--quiet");
    // The tools ask this very program, for the points of a scene or for all that a suite computes.
    setenv("HAPBENCH_PROGRAM", this_program().c_str(), 1);
  }

  /// Passes an option on unless it is empty. One word holds both, so that a value may begin with "-".
  void add(const char* name, const std::string& value) {
    if (!value.empty()) words_.push_back(fmt::format("{}={}", name, value));
  }
  void add(std::string word) { words_.push_back(std::move(word)); }

  const std::vector<std::string>& words() const { return words_; }
  const char* launcher() const { return words_[0].c_str(); }
  /// Becomes the tool; returns only by an exception.
  int become() {
    execv(launcher(), arguments().data());
    fail(errno);
  }
  /// The words as exec takes them, valid while this object lives unchanged.
  std::vector<char*> arguments() {
    std::vector<char*> pointers;
    for (std::string& word : words_) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return pointers;
  }
  [[noreturn]] void fail(int error) const {
    throw IoError("run the drawing tool of hapbench's source tree,", words_[0],
                  std::error_code(error, std::generic_category()));
  }

 private:
  std::vector<std::string> words_;
};

int become(const std::string& tool, const PictureOptions& options) {
  ToolCommand command(kPictures, tool, options.quiet);
  command.add("--y", options.quantities);
  command.add("--metric", options.metric);
  for (const std::string& condition : options.where) command.add("--where", condition);
  command.add("--from", options.from);
  command.add("--to", options.to);
  command.add("--out", options.out);
  if (options.no_sketch) command.add("--no-sketch");
  command.add("--");
  for (const std::string& run : options.runs) command.add(run);
  return command.become();
}

int plot(const PictureOptions& options) {
  return become("plot", options);
}

int report(const PictureOptions& options) {
  for (const std::string& folder : options.runs) check_comparison(folder, options.quiet);
  return become("report", options);
}

void add_common(Command& command, PictureOptions& options, const std::string& runs, const std::string& out) {
  command.add("RUN", options.runs, runs).required();
  command.add("--out", options.out, out);
  command.flag("--quiet", options.quiet, "print nothing on standard output");
}

}  // namespace

namespace {

/// Runs the tool beside this program and waits; `doing` is what the user is told.
void finish_tool(ToolCommand& command, const char* doing, const std::filesystem::path& folder, bool quiet) {
  std::fflush(stdout);
  pid_t tool = 0;
  if (const int error = posix_spawn(&tool, command.launcher(), nullptr, nullptr, command.arguments().data(), environ))
    command.fail(error);
  const WaitNotice notice(doing, !quiet);
  int status = 0;
  while (waitpid(tool, &status, 0) < 0 && errno == EINTR) {
  }
  throw_if_stopped();
  if (status != 0) throw IoError("draw what is in", folder, std::make_error_code(std::errc::io_error));
}

}  // namespace

void write_report(const std::filesystem::path& folder, bool quiet) {
  ToolCommand command(kPictures, "report", quiet);
  command.add("--");
  command.add(folder.string());
  finish_tool(command, "writing the report", folder, quiet);
}

void write_way(const std::filesystem::path& folder, const std::filesystem::path& file, bool quiet) {
  ToolCommand command(kPictures, "plot", true);
  command.add("--y", "path");
  command.add("--out", file.string());
  command.add("--");
  command.add(folder.string());
  finish_tool(command, "drawing", folder, quiet);
}

void add_plot(CommandLine& line) {
  auto [command, options] = line.command(
      "plot", "Draw runs over time and in space, a sweep, a stability map: a sketch here and a picture", plot);
  add_common(command, options, "folders that run, compare (also --devices), sweep, stability --map or limit wrote",
             "FILE.svg, .png or .pdf (default: plot.svg in the folder of the runs)");
  command.add("--y", options.quantities, "the quantities to draw, separated by commas (below)");
  command.add("--metric", options.metric, "for a sweep: the column of sweep.csv to draw");
  command.add("--where", options.where, "for a sweep: only runs with this, as 'inside_max_m<3e-4' (sweep --help)")
      .repeatable();
  command.add("--from", options.from, "time from which to draw [s]");
  command.add("--to", options.to, "time up to which to draw [s]");
  command.flag("--no-sketch", options.no_sketch, "print no sketch, only write the picture");
  command.footer(
      "--y takes force, spring, measured, input, reference, force_error, torque (needs record.torque), depth, ratio, "
      "contacts, rendered, speed, x, y, z, path, energy, input_energy, or any column of the runs' tables; by default "
      "force, depth, ratio, contacts, path, and energy where it was recorded. force, speed and the like are lengths of "
      "vectors, drawn as |rendered force|; --y fx_N,fy_N,fz_N draws the components.\n"
      "A comparison's folder stands for all its runs. Runs have the colour of their algorithm; several runs of one "
      "algorithm have colours of their own. Triangles mark the first touch. A peak of more than three times the range "
      "of settled contact is cut off, and its value written there. Of long runs the least and the greatest value for "
      "each pixel are drawn, so that no spike is lost.\n"
      "Of a sampled sweep the metric is drawn over each field, with how much each matters: Spearman's rank correlation and "
      "the first-order Sobol index.\n"
      "  hapbench plot results/out/compare_drag --y force,depth --out drag.png");
}

void add_report(CommandLine& line) {
  auto [command, options] =
      line.command("report", "Write a page of runs: curves, replay with sound, metrics, scenario, commands", report);
  add_common(command, options, "folders that run or compare wrote",
             "FILE.html (default: report.html in the folder of the runs)");
  command.footer(
      "One HTML file that needs no server and no network. Of a comparison it says whether the ranking holds; where "
      "that was not checked, all of it runs anew first (compare --check). The replay shows up to four runs side by side, with their "
      "depths if they were run with --set record.contacts=true.\n"
      "  hapbench report results/out/compare_drag");
}

namespace {

struct SuiteOptions {
  std::string what, algorithm, python, division, licence, shard, draw, out;
  std::vector<std::string> names, overrides, sources;
  unsigned jobs = 0;
  SlurmOptions slurm;
  bool replays = false, quiet = false;
};

/// The options that identify a submission (its law, division and licence), as words of a command line.
std::vector<std::string> words_of(const SuiteOptions& options) {
  std::vector<std::string> words = plugin_words();
  const auto add = [&words](const char* name, const std::string& value) {
    if (!value.empty()) words.push_back(fmt::format("{}={}", name, value));
  };
  add("--algorithm", options.algorithm);
  add("--python", options.python);
  add("--division", options.division);
  for (const std::string& field : options.overrides) add("--set", field);
  add("--licence", options.licence);
  for (const std::string& file : options.sources) add("--source", file);
  return words;
}

/// Begins the submission, which finds what is wrong with the law, and leaves its parts to Slurm.
int submit(const SuiteOptions& options, ToolCommand& tool) {
  tool.add("--begin");
  const ProgramOutput begun = output_of(tool.words());
  if (begun.status != 0) {
    std::fputs(begun.text.c_str(), stderr);
    return begun.status;
  }
  // The last line; warnings may stand before it.
  const std::string said = begun.text.substr(0, begun.text.find_last_not_of('\n') + 1);
  const std::filesystem::path folder = said.substr(said.rfind('\n') + 1);
  std::vector<std::string> words = {this_program().string(), "suite", "run"};
  for (const auto& more : {options.names, words_of(options), {"--out", folder.string(), "--quiet"}})
    words.insert(words.end(), more.begin(), more.end());
  const SlurmOptions& slurm = options.slurm;
  const std::string cpus = fmt::format("cpus-per-task={}", slurm.cpus);
  const std::string line =
      fmt::format("cd {} && exec {} --jobs {}", shell_line({std::filesystem::current_path().string()}),
                  shell_line(words), slurm.cpus);
  // A call computes only the parts that are missing, so that a preempted or killed task continues.
  const std::vector<SlurmScript> scripts = {
      slurm_script(slurm, folder, "suite", "slurm_%a.log",
                   {fmt::format("array=0-{}", slurm.shards - 1), cpus, "requeue"},
                   fmt::format("{} --shard \"$SLURM_ARRAY_TASK_ID/{}\"\n", line, slurm.shards)),
      slurm_script(slurm, folder, "finish", "slurm_finish.log", {cpus, "kill-on-invalid-dep=yes"}, line + "\n")};
  for (const SlurmScript& script : scripts) write_file_atomically(script.file, script.text);
  std::string text;
  if (slurm.dry_run) {
    text = dry_run_text(scripts);
  } else {
    const std::string array = submit_script(scripts[0]), last = submit_script(scripts[1], array);
    text = fmt::format("{} shards submitted as job {}, their end as job {}\n{}\n", slurm.shards, array, last,
                       folder.string());
  }
  if (!options.quiet) fmt::print("{}", text);
  return kSuccess;
}

int suite(const SuiteOptions& options) {
  ToolCommand command("hapbench_suite", options.what, options.quiet);
  for (const std::string& word : words_of(options)) command.add(word);
  command.add("--shard", options.shard);
  command.add("--draw", options.draw);
  if (options.replays) command.add("--replays");
  if (options.jobs > 0) command.add("--jobs", std::to_string(options.jobs));
  command.add("--out", options.out);
  for (const std::string& name : options.names) command.add("--name", name);
  return options.slurm.shards > 0 ? submit(options, command) : command.become();
}

}  // namespace

void add_suite(CommandLine& line) {
  auto [command, options] = line.command(
      "suite", "Judge a law of your own in frozen scenes, verify such a judgement, draw a page of all", suite);
  command.add("what", options.what, "run, verify or page; freeze for a suite of your own")
      .required()
      .one_of({"run", "verify", "page", "freeze"});
  command.add(
      "names", options.names,
      "run, freeze: a suite, 1 or a folder with suite.json; verify: the folder of a submission; page: such folders, "
      "or a CSV file of this command");
  command.add("--algorithm", options.algorithm, "the law, where the program, the plugin or the script has several");
  command.add("--python", options.python,
              "FILE.py, a script that defines a law and ends with hapbench.main(); --plugin takes one in C or C++");
  command.add("--division", options.division, "closed: the law alone; open: fields of rendering, too (default: closed)")
      .one_of({"closed", "open"});
  command.add("--set", options.overrides, "open division: a field of rendering in all scenes, path=value").repeatable();
  command.add("--licence", options.licence, "of the law, as an SPDX name");
  command.add("--source", options.sources, "a file to keep with the submission, as the law's source").repeatable();
  CommandOption shard = command.add("--shard", options.shard,
                                    "i/n: a part of the scenes, into the same --out; a call without it finishes");
  add_slurm_options(command, options.slurm, shard,
                    "N: submit run to Slurm as a job array of N shards, and a job that finishes when all are done");
  add_jobs(command, options.jobs, "runs at once (default: one per processor)");
  command.add("--draw", options.draw, "verify: repeat the verification with this number, which it printed");
  command.flag(
      "--replays", options.replays,
      "page: run the first failure of each law in each scene again, into pages that the table of failures links to");
  command.add("--out", options.out,
              "run: folder of the submission (default: results/out/suite_SUITE_LAW); page: FILE.html (default: "
              "results/out/arena.html)");
  command.flag("--quiet", options.quiet, "print nothing on standard output");
  command.footer(
      "run takes a law through all scenes and limits of a suite, with all seeds, and writes a folder: the law and its hash, "
      "every run with its state hash, scores of each axis with their intervals over the seeds, times. What is there is not "
      "computed again, so that an interrupted call goes on and shards share a folder.\n"
      "verify runs a random third again and compares every hash and number, and judges the scores by seeds that nobody could "
      "know: status 0, or 3 and a list of what differs.\n"
      "page writes one HTML file of any number of submissions, sortable, with Pareto fronts, profiles and the command that "
      "repeats each row; beside it a CSV file from which the page can be made again.\n"
      "  hapbench suite run 1 --plugin law.so --source law.c --licence MIT\n"
      "  hapbench suite verify results/out/suite_1_law\n"
      "  hapbench suite page results/reference/arena.csv results/out/suite_1_law");
}

}  // namespace hapbench
