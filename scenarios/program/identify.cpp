#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/python_command.hpp"
#include "scenarios/program/table.hpp"

/// `hapbench identify`. The Python package hapbench_identify fits the device and designs signals.
namespace hapbench {
namespace {

namespace fs = std::filesystem;

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
  const std::string next = kind.empty() ? shell_line({"hapbench", "compare", "--devices", out.string()})
                                        : fmt::format("command these forces, log time_s,force_N,position_m, then {}",
                                                      shell_line({"hapbench", "identify", "LOG.csv"}));
  options.print_made((*answer)["json"], out, table, next);
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
      "  hapbench compare --devices log_device.json");
  command.runs([options] { return identify(*options); });
}

}  // namespace hapbench
