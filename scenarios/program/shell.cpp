#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "results/io/atomic_file.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/shell_file.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

struct ShellOptions {
  std::string scenario;
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;
};

int shell(const ShellOptions& options) {
  const LoadedScenario loaded = load_scenario(find_scenario(options.scenario), options.overrides);
  if (std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment)) {
    throw InputError(loaded.file.string() + ": /environment/type: got \"springs\", which have no point shell");
  }
  const std::vector<SurfacePoint> points = [&] {
    const WaitNotice notice("building the shell", !options.output.quiet);
    print_warnings(check_named_files(loaded));
    const auto made = make_shell(loaded.scenario, loaded.files);
    throw_if_stopped();  // that may have taken seconds
    return made->points();
  }();
  const std::filesystem::path file = options.out;
  const std::string text = point_shell_text(points, file);
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw InputError(fmt::format("--out {}: is a directory", file.string()));
  const std::filesystem::path directory = file.has_parent_path() ? file.parent_path() : ".";
  require_writable_directory(directory);
  write_file_atomically(file, text);
  print(options.output, fmt::format("{} points in {}\n", points.size(), file.string()),
        {{"points", points.size()}, {"file", file.string()}});
  return kSuccess;
}

}  // namespace

void add_shell(CommandLine& line) {
  auto options = std::make_shared<ShellOptions>();
  Command command = line.command("shell", "Write the environment's point shell: positions and normals");
  command.add("scenario", options->scenario, "scenario file, or name of a bundled scenario").required();
  command.add("--out", options->out, "FILE.csv (exact) or FILE.ply (single precision, for viewers)").required();
  command.add("--set", options->overrides, "override a field: path=value").repeatable();
  add_output_options(command, options->output);
  command.runs([options] { return shell(*options); });
}

}  // namespace hapbench
