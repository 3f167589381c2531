#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "results/io/atomic_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

/// Commands whose work Python packages do. `hapbench identify`: hapbench_identify fits the device and designs signals.
/// `hapbench import`: hapbench_import reads, resamples and smooths recordings.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The options of a command whose work a Python package does: those that are given reach it as NAME=VALUE, several
/// times for a list. Names are without "--".
struct PythonOptions {
  std::map<std::string, std::string> words;
  std::map<std::string, std::vector<std::string>> lists;
  std::map<std::string, double> numbers;  ///< negative: not given
  std::map<std::string, bool> flags;
  OutputOptions output;

  CommandOption list(Command& command, const std::string& name, const std::string& help);
  CommandOption word(Command& command, const std::string& name, const std::string& help);
  CommandOption number(Command& command, const std::string& name, const std::string& help, double otherwise = -1.0);
  CommandOption flag(Command& command, const std::string& name, const std::string& help);

  /// Runs the package, `doing` what the user is told meanwhile, with the words `more` besides those given. Returns its
  /// reply; nothing where it ended without one, after its reason was printed. Throws the faults that it reports,
  /// IoError with the file `out` among them.
  std::optional<Json> reply(const char* package, const char* doing, const std::filesystem::path& out,
                            const std::vector<std::string>& more) const;
  /// Prints the warnings of the reply's JSON, the file that the package made, its table and the `next` command, which
  /// the JSON gets, too.
  void print_made(Json& json, const std::filesystem::path& out, const Table& table, const std::string& next) const;
};

/// The reason why a package ended without a reply, such as a missing package: the last line of its output.
std::string last_line(std::string_view text) {
  constexpr std::string_view kPrefix = "hapbench: error: ";
  while (text.ends_with('\n')) text.remove_suffix(1);
  text.remove_prefix(text.rfind('\n') + 1);
  if (text.starts_with(kPrefix)) text.remove_prefix(kPrefix.size());
  return one_line(std::string(text));
}

CommandOption PythonOptions::list(Command& command, const std::string& name, const std::string& help) {
  return command.add("--" + name, lists[name], help).comma_separated();
}

CommandOption PythonOptions::word(Command& command, const std::string& name, const std::string& help) {
  return command.add("--" + name, words[name], help);
}

CommandOption PythonOptions::number(Command& command, const std::string& name, const std::string& help,
                                    double otherwise) {
  return command.add("--" + name, numbers[name] = otherwise, help);
}

CommandOption PythonOptions::flag(Command& command, const std::string& name, const std::string& help) {
  return command.flag("--" + name, flags[name], help);
}

std::optional<Json> PythonOptions::reply(const char* package, const char* doing, const std::filesystem::path& out,
                                         const std::vector<std::string>& more) const {
  std::vector<std::string> line = {(installed_folder("scripts/python") / "launch").string(), package,
                                   fmt::format("out={}", out.string())};
  const auto add = [&line](std::string_view name, const auto& value) {
    line.push_back(fmt::format("{}={}", name, value));
  };
  for (const std::string& word : more)
    if (!word.empty()) line.push_back(word);
  for (const auto& [name, word] : words)
    if (!word.empty()) add(name, word);
  for (const auto& [name, list] : lists)
    for (const std::string& word : list) add(name, word);
  for (const auto& [name, number] : numbers)
    if (number >= 0.0) add(name, number);
  for (const auto& [name, is_given] : flags)
    if (is_given) add(name, true);
  const ProgramOutput tool = [&] {
    const WaitNotice notice(doing, !output.quiet);
    return output_of(line);
  }();
  throw_if_stopped();
  if (tool.status != 0) {
    print_error(last_line(tool.text));
    return std::nullopt;
  }
  // The last line of the output: a shell may have warned of the locale before.
  Json answer = parse_json(tool.text.substr(tool.text.rfind('\n') + 1));
  if (answer.contains("io_error"))
    throw IoError("write", out, std::error_code(answer["io_error"].get<int>(), std::generic_category()));
  std::vector<InputError> faults;
  for (const Json& fault : answer.value("faults", Json::array()))
    faults.emplace_back(InputError::Kind::relation, fault[0].get<std::string>(), fault[1].get<std::string>());
  if (!faults.empty()) throw InputError::all(faults);
  return answer;
}

void PythonOptions::print_made(Json& json, const std::filesystem::path& out, const Table& table,
                               const std::string& next) const {
  print_warnings(json["warnings"].get<std::vector<std::string>>());
  json["next"] = next;
  print(output, fmt::format("{}\n{}\nnext: {}\n", out.string(), table.text(), next), json);
}

struct IdentifyOptions : PythonOptions {
  std::string file, out;
};

int identify(const IdentifyOptions& options) {
  const std::string& kind = options.words.at("design");
  if (kind.empty() == options.file.empty())
    throw InputError("identify takes either a LOG or --design, which makes the signal to play and to log");
  const fs::path file = options.file;
  const fs::path out = !options.out.empty() ? fs::path(options.out)
                       : kind.empty()       ? fs::path(file.stem().string() + "_device.json")
                                            : fs::path("signal_" + kind + ".csv");
  if (std::error_code ignored; fs::equivalent(file, out, ignored))
    throw InputError(fmt::format("--out {}: is the log itself; allowed: another file", out.string()));
  require_writable_directory(out.has_parent_path() ? out.parent_path() : ".");
  std::optional<Json> answer = options.reply("hapbench_identify", kind.empty() ? "identifying" : "designing", out,
                                             {fmt::format("file={}", options.file)});
  if (!answer) return kInternalFault;
  Table table({{kind.empty() ? "of the device" : "of the signal", false}, {""}, {"from"}, {"to, 95 %"}});
  for (const Json& row : (*answer)["table"]) table.add(row.get<std::vector<std::string>>());
  const std::string next = kind.empty() ? shell_line({"hapbench", "limit", "tap_wall", "--device", out.string()})
                                        : fmt::format("command these forces, log time_s,force_N,position_m, then {}",
                                                      shell_line({"hapbench", "identify", "LOG.csv"}));
  options.print_made((*answer)["json"], out, table, next);
  return kSuccess;
}

struct ImportOptions : PythonOptions {
  std::string file, out;
  bool lists_presets = false;
};

fs::path presets_folder() {
  return installed_folder("scenarios/import/presets");
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

void add_identify(CommandLine& line) {
  auto options = std::make_shared<IdentifyOptions>();
  Command command = line.command("identify", "Make a device's file from its log: mass, friction, delay, encoder");
  command.add("log", options->file, "CSV of one axis: time, commanded force, position of the handle, no hand on it");
  options->list(command, "columns", "where quantities are, by name or number from 1 (below)");
  options->list(command, "scale", "what units are: time [s], force [N], position [m] (below)");
  options->flag(command, "skip-bad-rows", "leave bad rows out and say which, instead of refusing");
  options->word(command, "design", "instead of reading a log, make the signal to play: chirp, steps, multisine")
      .one_of({"chirp", "steps", "multisine"});
  options->number(command, "force", "of --design: largest force [N]; default 1", 1.0);
  options->number(command, "travel", "of --design: way that the handle has [m]; default 0.05", 0.05);
  options->number(command, "mass", "of --design: least mass that the handle may have [kg]; default 0.05", 0.05);
  options->number(command, "rate", "of --design: of the samples [Hz]; default 1000", 1000.0);
  options->number(command, "duration", "of --design [s]; default 5", 5.0);
  command.add("--out", options->out,
              "the device, LOG_device.json by default, with a picture of the residual beside it; or "
              "the signal, signal_KIND.csv");
  add_output_options(command, options->output);
  command.footer(
      "Fits m x'' = u(t - delay) + offset - b x' - c sign(x') to the positions by least squares, integrated exactly. The "
      "delay is found in fractions of a sample. Intervals are of 95 %, wider where the residual is correlated; a "
      "parameter whose interval is wider than itself cannot be told and is not written. The noise is what the residual "
      "has beyond the encoder's step. A constant force besides the commands is told and not part of a device.\n"
      "--columns: time, force and position, by default time_s, force_N and position_m. Forces are as commanded at the "
      "time of the row, positive in the direction of the position.\n"
      "  hapbench identify --design chirp --force 2 --travel 0.08 --mass 0.1 --out chirp.csv\n"
      "  hapbench identify log.csv --columns time=t,force=3,position=enc --scale time=1e-6,position=5.5e-5\n"
      "  hapbench limit tap_wall --device log_device.json");
  command.runs([options] { return identify(*options); });
}

void add_import(CommandLine& line) {
  auto options = std::make_shared<ImportOptions>();
  Command command = line.command("import", "Make a stroke to play back from a recording: poses and measured forces");
  command.add("file", options->file, "the recording");
  command.add("--preset", options->words["preset"], "a layout by name or from FILE.json; options below override it");
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
