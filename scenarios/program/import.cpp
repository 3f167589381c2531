#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "algorithms/rendering_config.hpp"
#include "results/io/atomic_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/python_command.hpp"
#include "scenarios/program/table.hpp"

/// `hapbench import`. The Python package hapbench_import reads, resamples and smooths recordings.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct ImportOptions : PythonOptions {
  std::string file, out;
  bool lists_presets = false;
};

fs::path presets_folder() {
  return installed_folder("scenarios/import/presets");
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(presets_folder())) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The stroke's file, after it was checked.
fs::path stroke_file(const ImportOptions& options) {
  if (options.file.empty()) throw InputError("FILE is missing: the recording; \"hapbench import --help\" explains");
  if (options.words.at("preset").empty() && options.lists.at("columns").empty())
    throw InputError("--columns or --preset is missing: which columns hold time and position?");
  const fs::path file = options.file;
  const fs::path out = options.out.empty() ? fs::path(file.stem().string() + "_stroke.csv") : fs::path(options.out);
  if (std::error_code ignored; fs::equivalent(file, out, ignored))
    throw InputError(fmt::format("--out {}: is the recording itself; allowed: another file", out.string()));
  require_writable_directory(out.has_parent_path() ? out.parent_path() : ".");
  return out;
}

int import(const ImportOptions& options) {
  const fs::path out = options.lists_presets ? fs::path() : stroke_file(options);
  std::optional<Json> answer = options.reply(
      "hapbench_import", "importing", out,
      {fmt::format("presets={}", presets_folder().string()), fmt::format("file={}", options.file),
       fmt::format("stiffness_N_per_m={}", RenderingConfig().stiffness), options.lists_presets ? "list=true" : ""});
  if (!answer) return kInternalFault;
  Json& reply = *answer;
  Table table(
      {{options.lists_presets ? "PRESET" : "of the stroke", false}, {options.lists_presets ? "of" : "", false}});
  for (const Json& row : reply["table"]) table.add({row[0].get<std::string>(), row[1].get<std::string>()});
  Json& json = reply["json"];
  if (options.lists_presets) {
    print(options.output,
          fmt::format("{}\nCopy one from {}, correct it and give it as --preset FILE.json.\n", table.text(),
                      presets_folder().string()),
          json);
    return kSuccess;
  }
  const std::string scenario = out.stem().string() + ".json";
  const std::string next = shell_line({"hapbench", "new", "stroke", "--from", out.string(), "--out", scenario}) +
                           " && " + shell_line({"hapbench", "run", scenario});
  options.print_made(json, out, table, next);
  return kSuccess;
}

}  // namespace

void add_import(CommandLine& line) {
  auto options = std::make_shared<ImportOptions>();
  Command command = line.command("import", "Make a stroke to play back from a recording: poses and measured forces");
  command.add("file", options->file, "the recording");
  command.add("--preset", options->words["preset"], "a layout by name or from FILE.json; options below override it")
      .words(preset_names);
  command.flag("--list", options->lists_presets, "list the presets");
  options->word(command, "format", "csv (default), traj (blanks between numbers), hapi, hapi-binary")
      .one_of({"csv", "traj", "hapi", "hapi-binary"});
  options->flag(command, "floats", "hapi-binary: numbers of four bytes");
  options->list(command, "columns", "where quantities are, by name or number from 1 (below)");
  options->list(command, "scale", "what units are: time [s], position [m], angle [rad], force [N] (below)");
  options->number(command, "sample-rate", "[Hz] of a file without a column of times");
  options->word(command, "orientation", "what its columns hold; default none: the tool never turns")
      .one_of({"none", "axis", "quat_wxyz", "quat_xyzw", "axis_angle", "matrix"});
  options->list(command, "tip-axis", "x,y,z: direction out of the tip in the tool's frame; default 0,0,-1");
  options->list(command, "frame", "recorded directions that are the scenario's x, y, z; y up: x,-z,y");
  options->list(command, "shift", "x,y,z: added to the places of the tip [m], in the scenario's frame");
  options->flag(command, "force-by-tool",
                "forces are the tool's on the object, not the object's on the tool: turn them round");
  options->number(command, "rate", "[Hz] of the stroke; default: as recorded, or the median's if irregular");
  options->list(command, "smooth", "window=N,order=M: Savitzky-Golay over N samples, an odd number");
  options->number(command, "max-speed", "faster jumps are refused [m/s]; default 5");
  options->number(command, "max-gap", "longer gaps are refused, not bridged [s]; default 0.5");
  options->flag(command, "skip-bad-rows", "leave bad rows out and say which, instead of refusing");
  command.add("--out", options->out, "the stroke; default: FILE_stroke.csv here");
  add_output_options(command, options->output);
  command.footer(
      "--columns: time, and position, orientation and force by the first of their columns, or each by itself as px, py, "
      "pz, qw, qx, qy, qz, mfx, mfy, mfz. --orientation is none, axis (the direction out of the tip), quat_wxyz, "
      "quat_xyzw, axis_angle (axis, angle) or matrix (r11, r12 ... r33, row by row); it turns the tool's frame into the "
      "world's.\n"
      "Rows with wrong numbers, times that do not increase, quaternions that are no unit and jumps are refused with their "
      "lines, and nothing is written.\n"
      "  hapbench import log.txt --preset hapi --smooth window=11,order=3 --out stroke.csv\n"
      "  hapbench import rec.csv --columns time=t,position=5,orientation=8,force=fx \\\n"
      "    --orientation quat_xyzw --scale time=1e-6,position=0.001");
  command.runs([options] { return import(*options); });
}

}  // namespace hapbench
