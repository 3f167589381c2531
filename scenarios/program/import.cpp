#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "algorithms/rendering_config.hpp"
#include "results/io/atomic_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

/// `hapbench import`. The Python package hapbench_import reads, resamples and smooths recordings.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The options as given; the maps have the names without "--".
struct ImportOptions {
  std::string file, out;
  bool list = false;
  std::map<std::string, std::string> words;
  std::map<std::string, std::vector<std::string>> lists;
  std::map<std::string, double> numbers;  ///< negative: not given
  std::map<std::string, bool> flags;
  OutputOptions output;
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

/// Runs hapbench_import, whose words are NAME=VALUE, several times for a list.
ProgramOutput run_tool(const ImportOptions& options, const fs::path& out) {
  std::vector<std::string> words = {(installed_folder("scripts/python") / "launch").string(), "hapbench_import"};
  const auto add = [&words](std::string_view name, const auto& value) {
    words.push_back(fmt::format("{}={}", name, value));
  };
  add("presets", presets_folder().string());
  add("file", options.file);
  add("out", out.string());
  add("stiffness_N_per_m", RenderingConfig().stiffness);
  for (const auto& [name, word] : options.words) {
    if (!word.empty()) add(name, word);
  }
  for (const auto& [name, list] : options.lists) {
    for (const std::string& word : list) add(name, word);
  }
  for (const auto& [name, number] : options.numbers) {
    if (number >= 0.0) add(name, number);
  }
  for (const auto& [name, is_given] : options.flags) {
    if (is_given) add(name, true);
  }
  if (options.list) words.emplace_back("list=true");
  const WaitNotice notice("importing", !options.output.quiet);
  return output_of(words);
}

/// The reply of the tool, the last line of its output: a shell may have warned of the locale before. Throws the errors
/// that it reports.
Json reply_in(const std::string& text, const fs::path& out) {
  Json reply = parse_json(text.substr(text.rfind('\n') + 1));
  if (reply.contains("io_error"))
    throw IoError("write", out, std::error_code(reply["io_error"].get<int>(), std::generic_category()));
  std::vector<InputError> faults;
  for (const Json& fault : reply.value("faults", Json::array()))
    faults.emplace_back(InputError::Kind::relation, fault[0].get<std::string>(), fault[1].get<std::string>());
  if (!faults.empty()) throw InputError::all(faults);
  return reply;
}

/// The reason why the tool ended without a reply, such as a missing package: the last line of its output.
std::string last_line(std::string_view text) {
  constexpr std::string_view kPrefix = "hapbench: error: ";
  while (text.ends_with('\n')) text.remove_suffix(1);
  text.remove_prefix(text.rfind('\n') + 1);
  if (text.starts_with(kPrefix)) text.remove_prefix(kPrefix.size());
  return one_line(std::string(text));
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
  const fs::path out = options.list ? fs::path() : stroke_file(options);
  const ProgramOutput tool = run_tool(options, out);
  throw_if_stopped();
  if (tool.status != 0) {
    print_error(last_line(tool.text));
    return kInternalFault;
  }
  Json reply = reply_in(tool.text, out);
  Table table({{options.list ? "PRESET" : "of the stroke", false}, {options.list ? "of" : "", false}});
  for (const Json& row : reply["table"]) table.add({row[0].get<std::string>(), row[1].get<std::string>()});
  Json& json = reply["json"];
  if (options.list) {
    print(options.output,
          fmt::format("{}\nCopy one from {}, correct it and give it as --preset FILE.json.\n", table.text(),
                      presets_folder().string()),
          json);
    return kSuccess;
  }
  print_warnings(json["warnings"].get<std::vector<std::string>>());
  const std::string scenario = out.stem().string() + ".json";
  const std::string next = shell_line({"hapbench", "new", "stroke", "--from", out.string(), "--out", scenario}) +
                           " && " + shell_line({"hapbench", "run", scenario});
  json["next"] = next;
  print(options.output, fmt::format("{}\n{}\nnext: {}\n", out.string(), table.text(), next), json);
  return kSuccess;
}

}  // namespace

void add_import(CommandLine& line) {
  auto options = std::make_shared<ImportOptions>();
  Command command = line.command("import", "Make a stroke to play back from a recording: poses and measured forces");
  const auto list = [&](const std::string& name, const std::string& help) {
    command.add("--" + name, options->lists[name], help).comma_separated();
  };
  const auto word = [&](const std::string& name, const std::vector<std::string>& allowed, const std::string& help) {
    command.add("--" + name, options->words[name], help).one_of(allowed);
  };
  const auto number = [&](const std::string& name, const std::string& help) {
    command.add("--" + name, options->numbers[name] = -1.0, help);
  };
  const auto flag = [&](const std::string& name, const std::string& help) {
    command.flag("--" + name, options->flags[name], help);
  };
  command.add("file", options->file, "the recording");
  command.add("--preset", options->words["preset"], "a layout by name or from FILE.json; options below override it")
      .words(preset_names);
  command.flag("--list", options->list, "list the presets");
  word("format", {"csv", "traj", "hapi", "hapi-binary"},
       "csv (default), traj (blanks between numbers), hapi, hapi-binary");
  flag("floats", "hapi-binary: numbers of four bytes");
  list("columns", "where quantities are, by name or number from 1 (below)");
  list("scale", "what units are: time [s], position [m], angle [rad], force [N] (below)");
  number("sample-rate", "[Hz] of a file without a column of times");
  word("orientation", {"none", "axis", "quat_wxyz", "quat_xyzw", "axis_angle", "matrix"},
       "what its columns hold; default none: the tool never turns");
  list("tip-axis", "x,y,z: direction out of the tip in the tool's frame; default 0,0,-1");
  list("frame", "recorded directions that are the scenario's x, y, z; y up: x,-z,y");
  list("shift", "x,y,z: added to the places of the tip [m], in the scenario's frame");
  flag("force-by-tool", "forces are the tool's on the object, not the object's on the tool: turn them round");
  number("rate", "[Hz] of the stroke; default: as recorded, or the median's if irregular");
  list("smooth", "window=N,order=M: Savitzky-Golay over N samples, an odd number");
  number("max-speed", "faster jumps are refused [m/s]; default 5");
  number("max-gap", "longer gaps are refused, not bridged [s]; default 0.5");
  flag("skip-bad-rows", "leave bad rows out and say which, instead of refusing");
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
