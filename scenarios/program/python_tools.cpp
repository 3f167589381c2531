#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/shell_words.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/run/wait_notice.hpp"

/// Commands that draw: they hand their words to Python, which reads the result files. Nothing of a run passes through
/// here.
namespace hapbench {
namespace {

struct PictureOptions {
  std::vector<std::string> runs;
  std::string quantities;
  std::string metric;
  std::string from;
  std::string to;
  std::string out;
  bool no_sketch = false;
  bool quiet = false;
};

/// A command line of the tool; `words` go on from its name.
std::vector<std::string> tool_words(std::vector<std::string> words) {
  const auto launcher = installed_folder("scripts/python") / "launch";
  words.insert(words.begin(), {launcher.string(), "hapbench_pictures"});
  // The tools ask this very program for the points of a scene.
  setenv("HAPBENCH_PROGRAM", this_program().c_str(), 1);
  return words;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

[[noreturn]] void fail_to_run(const std::string& launcher, int number) {
  throw IoError("run the drawing tool of hapbench's source tree,", launcher,
                std::error_code(number, std::generic_category()));
}

/// Becomes the Python tool; returns only by an exception.
int become(const std::string& tool, const PictureOptions& options) {
  std::vector<std::string> words{tool};
  const auto add = [&words](const char* name, const std::string& value) {
    // In one word, so that a value that begins with "-" stays a value.
    if (!value.empty()) words.push_back(fmt::format("{}={}", name, value));
  };
  add("--y", options.quantities);
  add("--metric", options.metric);
  add("--from", options.from);
  add("--to", options.to);
  add("--out", options.out);
  if (options.no_sketch) words.emplace_back("--no-sketch");
  if (options.quiet) words.emplace_back("--quiet");
  words.emplace_back("--");
  words.insert(words.end(), options.runs.begin(), options.runs.end());
  words = tool_words(std::move(words));
  execv(words[0].c_str(), pointers_to(words).data());
  fail_to_run(words[0], errno);
}

void add_common(Command& command, PictureOptions& options, const std::string& runs, const std::string& out) {
  command.add("RUN", options.runs, runs).required();
  command.add("--out", options.out, out);
  command.flag("--quiet", options.quiet, "nothing on standard output");
}

}  // namespace

void write_report(const std::filesystem::path& folder, bool quiet) {
  std::vector<std::string> words{"report"};
  if (quiet) words.emplace_back("--quiet");
  words.insert(words.end(), {"--", folder.string()});
  words = tool_words(std::move(words));
  std::fflush(stdout);
  pid_t tool = 0;
  if (const int error = posix_spawn(&tool, words[0].c_str(), nullptr, nullptr, pointers_to(words).data(), environ))
    fail_to_run(words[0], error);
  const WaitNotice notice("writing the report", !quiet);
  int status = 0;
  while (waitpid(tool, &status, 0) < 0 && errno == EINTR) {
  }
  throw_if_stopped();
  if (status != 0) throw IoError("write the report of", folder, std::make_error_code(std::errc::io_error));
}

void add_plot(CommandLine& line) {
  auto options = std::make_shared<PictureOptions>();
  Command command =
      line.command("plot", "Draw runs over time and in space, a sweep, a stability map: a sketch here and a picture");
  add_common(command, *options, "folders that run, compare (also --devices), sweep, stability --map or limit wrote",
             "FILE.svg, .png or .pdf; default: plot.svg in the folder of the runs");
  command.add("--y", options->quantities, "what to draw, separated by commas (below)");
  command.add("--metric", options->metric, "of a sweep: the column of sweep.csv to draw");
  command.add("--from", options->from, "time from which to draw [s]");
  command.add("--to", options->to, "time up to which to draw [s]");
  command.flag("--no-sketch", options->no_sketch, "the picture alone");
  command.footer(
      "--y takes force, spring, measured, input, reference, force_error, torque (needs record.torque), depth, ratio, "
      "contacts, rendered, speed, x, y, z, path, energy, "
      "input_energy, or any column of the runs' tables; by default force, depth, ratio, contacts, path, and energy "
      "where it was recorded. force, speed and the like are lengths of vectors, drawn as |rendered force|; --y fx_N,fy_N,fz_N "
      "draws the components.\n"
      "A comparison's folder stands for all its runs. Every run has the colour of its algorithm, runs of one algorithm "
      "have colours of their own; triangles mark the first touch. A peak of more than three times what settled contact "
      "shows is cut off, and its value written there. Of long runs the least and the greatest value for each pixel are drawn, so that no spike is lost.\n"
      "  hapbench plot results/out/compare_drag --y force,depth --out drag.png");
  command.runs([options] { return become("plot", *options); });
}

void add_report(CommandLine& line) {
  auto options = std::make_shared<PictureOptions>();
  Command command =
      line.command("report", "Write a page of runs: curves, replay with sound, metrics, scenario, commands");
  add_common(command, *options, "folders that run or compare wrote",
             "FILE.html; default: report.html in the folder of the runs");
  command.footer(
      "One HTML file that needs no server and no network. The replay shows up to four runs side by side, with their "
      "depths where they were run with --set record.contacts=true.\n"
      "  hapbench report results/out/compare_drag");
  command.runs([options] { return become("report", *options); });
}

}  // namespace hapbench
