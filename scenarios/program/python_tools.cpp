#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>

#include "results/io/io_error.hpp"
#include "scenarios/program/command.hpp"

/// Commands that draw: they hand their words to Python, which reads the result files. Nothing of a run passes through
/// here.
namespace hapbench {
namespace {

struct PictureOptions {
  std::vector<std::string> runs;
  std::string quantities;
  std::string metric;
  std::string out;
  bool no_sketch = false;
  bool quiet = false;
};

/// Becomes the Python tool; returns only by an exception.
int become(const std::string& tool, const PictureOptions& options) {
  const std::filesystem::path launcher = std::filesystem::path(HAPBENCH_SCRIPTS_DIR) / "python" / "launch";
  std::vector<std::string> words{launcher.string(), "hapbench_pictures", tool};
  const auto add = [&words](const char* name, const std::string& value) {
    // In one word, so that a value that begins with "-" stays a value.
    if (!value.empty()) words.push_back(fmt::format("{}={}", name, value));
  };
  add("--y", options.quantities);
  add("--metric", options.metric);
  add("--out", options.out);
  if (options.no_sketch) words.emplace_back("--no-sketch");
  if (options.quiet) words.emplace_back("--quiet");
  words.emplace_back("--");
  words.insert(words.end(), options.runs.begin(), options.runs.end());

  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // The tools ask this very program for the points of a scene.
  std::error_code ignored;
  setenv("HAPBENCH_PROGRAM", std::filesystem::read_symlink("/proc/self/exe", ignored).c_str(), 1);
  execv(launcher.c_str(), arguments.data());
  const std::error_code reason(errno, std::generic_category());
  throw IoError("run the drawing tool of hapbench's source tree,", launcher, reason);
}

void add_common(Command& command, PictureOptions& options, const std::string& out) {
  command.add("RUN", options.runs, "folders that run, compare or sweep wrote").required();
  command.add("--out", options.out, out);
  command.flag("--quiet", options.quiet, "nothing on standard output");
}

}  // namespace

void add_plot(CommandLine& line) {
  auto options = std::make_shared<PictureOptions>();
  Command command = line.command("plot", "Draw runs over time and in space, or a sweep: a sketch here and a picture");
  add_common(command, *options, "FILE.svg, .png or .pdf; default: plot.svg in the folder of the runs");
  command.add("--y", options->quantities, "what to draw, separated by commas (below)");
  command.add("--metric", options->metric, "of a sweep: the column of sweep.csv to draw");
  command.flag("--no-sketch", options->no_sketch, "the picture alone");
  command.footer(
      "--y takes force, spring, measured, input, depth, ratio, contacts, rendered, speed, x, y, z, path,\n"
      "energy, input_energy, or any column of the runs' tables; by default force, depth, ratio, contacts,\n"
      "path, and energy where it was recorded.\n"
      "A comparison's folder stands for all its runs. Every run has the colour of its algorithm; triangles\n"
      "mark the first touch. Of long runs the least and the greatest value for each pixel are drawn, so\n"
      "that no spike is lost.\n"
      "  hapbench plot results/out/compare_drag --y force,depth --out drag.png");
  command.runs([options] { return become("plot", *options); });
}

void add_report(CommandLine& line) {
  auto options = std::make_shared<PictureOptions>();
  Command command =
      line.command("report", "Write a page of runs: curves, replay with sound, metrics, scenario, commands");
  add_common(command, *options, "FILE.html; default: report.html in the folder of the runs");
  command.footer(
      "One HTML file that needs no server and no network. The replay shows up to four runs side by side,\n"
      "with their depths where they were run with --set record.contacts=true.\n"
      "  hapbench report results/out/compare_drag");
  command.runs([options] { return become("report", *options); });
}

}  // namespace hapbench
