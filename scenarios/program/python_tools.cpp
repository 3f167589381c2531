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
#include "scenarios/program/command.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

/// Commands that draw: they pass their options on to Python, which reads the result files.
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
  std::string tolerance;
  std::string out;
  bool quiet = false;
};

/// The command line of a Python tool.
class ToolCommand {
 public:
  ToolCommand(const char* package, const std::string& tool, bool quiet)
      : words_{(installed_folder("scripts/python") / "launch").string(), package, tool} {
    if (quiet) words_.emplace_back("--quiet");
    // The tools ask this very program, for the points of a scene.
    setenv("HAPBENCH_PROGRAM", this_program().c_str(), 1);
  }

  /// Passes an option on unless it is empty. One word holds both, so that a value may begin with "-".
  void add(const char* name, const std::string& value) {
    if (!value.empty()) words_.push_back(fmt::format("{}={}", name, value));
  }
  void add(std::string word) { words_.push_back(std::move(word)); }

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
  command.add("--tolerance", options.tolerance);
  command.add("--out", options.out);
  command.add("--");
  for (const std::string& run : options.runs) command.add(run);
  return command.become();
}

int plot(const PictureOptions& options) {
  return become("plot", options);
}

int report(const PictureOptions& options) {
  return become("report", options);
}

void add_common(Command& command, PictureOptions& options, const std::string& runs, const std::string& out) {
  command.add("RUN", options.runs, runs).required();
  command.add("--out", options.out, out);
  command.flag("--quiet", options.quiet, "print nothing on standard output");
}

}  // namespace

void write_way(const std::filesystem::path& folder, const std::filesystem::path& file, bool quiet) {
  ToolCommand command(kPictures, "plot", true);
  command.add("--y", "path");
  command.add("--out", file.string());
  command.add("--");
  command.add(folder.string());
  std::fflush(stdout);
  pid_t tool = 0;
  if (const int error = posix_spawn(&tool, command.launcher(), nullptr, nullptr, command.arguments().data(), environ))
    command.fail(error);
  const WaitNotice notice("drawing", !quiet);
  int status = 0;
  while (waitpid(tool, &status, 0) < 0 && errno == EINTR) {
  }
  throw_if_stopped();
  if (status != 0) throw IoError("draw what is in", folder, std::make_error_code(std::errc::io_error));
}

void add_plot(CommandLine& line) {
  auto [command, options] = line.command("plot", "Draw runs over time and in space, a sweep, limits", plot);
  add_common(command, options, "folders that run, compare, sweep or limit wrote",
             "FILE.svg, .png or .pdf (default: plot.svg in the folder of the runs)");
  command.add("--y", options.quantities, "the quantities to draw, separated by commas (below)");
  command.add("--metric", options.metric, "for a sweep: the column of sweep.csv to draw");
  command.add("--where", options.where, "for a sweep: only runs with this, as 'inside_max_m<3e-4' (sweep --help)")
      .repeatable();
  command.add("--from", options.from, "time from which to draw [s]");
  command.add("--to", options.to, "time up to which to draw [s]");
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
  command.add(
      "--tolerance", options.tolerance,
      "no page: compare the results of two folders, in status 3 if they differ by more than this, of a metric relative "
      "to the larger of the two, of a column to its largest magnitude; 0: the same digits");
  command.footer(
      "One HTML file that needs no server and no network. The replay shows up to four runs side by side, with their "
      "depths if they were run with --set record.contacts=true. Of two runs, what differs comes first.\n"
      "For a regression test keep the results of a good version and compare every new one with them by --tolerance: outcome, "
      "metrics, warnings, trajectory.csv and sweep.csv, and with 0 the state hash. What one of them alone has makes them "
      "differ; fields are shown but do not count; provenance, times and counted work are not looked at.\n"
      "  hapbench report results/out/compare_drag\n"
      "  hapbench report results/good results/out --tolerance 1e-9");
}

}  // namespace hapbench
