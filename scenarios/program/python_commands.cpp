#include "scenarios/program/python_commands.hpp"
#include "scenarios/input/shell_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <system_error>

#include "device_model/handle_motion.hpp"
#include "results/io/atomic_file.hpp"
#include "scenarios/analysis/work_precision/pareto_front.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/linear_loop_request.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/program_context.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

struct ImportKind {
  std::string name, sentence, package;
};

const ImportKind kImportKinds[] = {
    {"stroke",
     "a recorded tool motion, with or without forces, becomes RECORDING_stroke.csv, for \"hapbench new stroke --from "
     "RECORDING_stroke.csv\"",
     "hapbench_import"},
    {"device",
     "a log of time, commanded force and position of a handle becomes LOG_device.json, for --device of limit, tune "
     "and audit",
     "hapbench_identify"}};

/// Returns a shell command that replaces the shell with the launcher of Python packages. `package`: the
/// package's name and its first arguments.
std::string launch_line(const ProgramArguments& package, const ProgramArguments& given, ProgramContext& context) {
  ProgramArguments arguments = {"exec", (installed_folder("scripts/python") / "launch").string()};
  arguments.insert(arguments.end(), package.begin(), package.end());
  arguments.insert(arguments.end(), given.begin(), given.end());
  // The packages call this executable for the points of a scene.
  setenv("HAPBENCH_PROGRAM", context.program.c_str(), 1);
  return shell_line(arguments);
}

[[noreturn]] void fail_to_launch() {
  throw IoError("run the Python of hapbench's source tree,", "scripts/python/launch",
                std::error_code(errno, std::generic_category()));
}

/// Runs the shell command in a child process. Returns its exit status and its standard output.
std::pair<int, std::string> run_subprocess(const std::string& line) {
  std::fflush(stdout);
  std::FILE* pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) fail_to_launch();
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  const int ended = ::pclose(pipe);
  return {WIFEXITED(ended) ? WEXITSTATUS(ended) : kStopped + WTERMSIG(ended), text};
}

/// Runs the shell command in a child process and stores the text and messages of the child in `host`. Returns the exit
/// status of the child. If this status is kBadInput, throws the errors that the child printed as InputError.
int run_captured(CapturedOutput& host, const std::string& line) {
  const auto [status, text] = run_subprocess(line + " 2>&1");
  constexpr std::string_view kError = "hapbench: error: ", kWarning = "hapbench: warning: ";
  // Sort the lines by their prefixes into errors, warnings and text.
  std::vector<InputError> faults;
  LineReader lines(text);
  while (const auto message = lines.next()) {
    if (message->starts_with(kError)) {
      faults.emplace_back(std::string(message->substr(kError.size())));
    } else if (message->starts_with(kWarning)) {
      host.warnings.emplace_back(message->substr(kWarning.size()));
    } else if (!message->starts_with("hapbench: ")) {  // skips notes on progress
      host.text.append(*message).append("\n");
    }
  }
  if (status == kBadInput && !faults.empty()) throw InputError::all(faults);
  for (const InputError& fault : faults) host.errors.emplace_back(fault.what());
  return status;
}

/// Internal argument of "hapbench import device". The Python package starts one process with this argument and requests
/// thousands of simulations of a device log from it. Standard input and standard output carry binary doubles. The input
/// is, in this order: the number of rows, the times of the rows, the forces of the rows, and the requests. A request is
/// a number of rows (0 ends the requests) and the fields of a LoggedHandle. The answer to a request with n rows is the
/// positions at the first n rows.
constexpr const char* kSimulateLog = "--simulate-log";

int simulate_log_for_pipe() {
  const auto read = [](double* values, std::size_t count) {
    return std::fread(values, sizeof(double), count, stdin) == count;
  };
  // Read the times and forces of all rows.
  double rows = 0.0;
  if (!read(&rows, 1) || !(rows >= 0.0 && rows < 1e9)) return kBadInput;
  std::vector<double> times(static_cast<std::size_t>(rows)), forces(times.size()), positions(times.size());
  if (!read(times.data(), times.size()) || !read(forces.data(), forces.size())) return kBadInput;
  // Answer requests until the input ends.
  std::array<double, 7> request{};
  while (read(request.data(), request.size()) && request[0] > 0.0 && request[0] <= rows) {
    const auto count = static_cast<std::size_t>(request[0]);
    const LoggedHandle handle{request[1], request[2], request[3], request[4], request[5], request[6]};
    simulate_log(handle, std::span(times).first(count), std::span(forces).first(count), positions);
    if (std::fwrite(positions.data(), sizeof(double), count, stdout) != count || std::fflush(stdout) != 0) break;
  }
  return kSuccess;
}

/// Internal argument of "hapbench plot" by which its Python package evaluates the conditions of --where. The arguments
/// after it are the folder of a sweep and the conditions. Prints the number of each run whose row in sweep.csv meets
/// all conditions, one number per line.
constexpr const char* kRunsWhere = "--runs-where";

constexpr const char* kKnee = "--knee";

/// Prints the index of the point that is the knee of the Pareto front of the given points (pareto_front.hpp); an empty
/// line if the front has no knee. The Python package of the figures marks this point in a picture. `given`: kKnee, then
/// a text COST:ERROR for each point.
int print_knee(const ProgramArguments& given, ProgramContext& context) {
  std::vector<CostAndError> points;
  for (std::size_t i = 1; i < given.size(); ++i) {
    const auto parts = parts_of(given[i], ':');
    const auto cost = finite_number(parts[0]), error = parts.size() == 2 ? finite_number(parts[1]) : std::nullopt;
    if (!cost || !error || !(*cost > 0.0) || !(*error > 0.0))
      throw InputError(fmt::format("plot: --knee: got \"{}\"; allowed: COST:ERROR, both above 0", given[i]));
    points.push_back({*cost, *error});
  }
  const auto found = knee(points, pareto_front(points));
  print(context, {}, found ? fmt::format("{}\n", *found) : "\n", {});
  return kSuccess;
}

int print_runs_where(const ProgramArguments& given, ProgramContext& context) {
  if (given.size() < 2) throw InputError("plot: --runs-where: got no folder; allowed: the folder of a sweep");
  const std::filesystem::path folder = given[1];
  const auto runs = runs_that_meet(folder / "sweep.csv", {given.begin() + 2, given.end()});
  print(context, {}, fmt::format("{}\n", fmt::join(runs, "\n")), {});
  return kSuccess;
}

/// Blocks Ctrl-C until the Python of the command handles it (stop_on_ctrl_c in hapbench_command.py). A blocked signal
/// stays pending across exec. Otherwise the shell would lose the signal, or Python would print a traceback of its
/// imports. Throws Stopped if the signal came before this function was called.
void leave_ctrl_c_to_python() {
  sigset_t ctrl_c;
  sigemptyset(&ctrl_c);
  sigaddset(&ctrl_c, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &ctrl_c, nullptr);
  throw_if_stopped();
}

/// Runs a package. If a host captures the output, the package runs in a child process. Otherwise this process becomes
/// the launcher.
int run(const ProgramArguments& package, const ProgramArguments& given, ProgramContext& context) {
  const std::string line = launch_line(package, given, context);
  if (context.captured != nullptr) return run_captured(*context.captured, line);
  leave_ctrl_c_to_python();
  ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
  fail_to_launch();
}

int run_import(const ProgramArguments& given, ProgramContext& context) {
  const Layout layout = context.layout();
  const std::string kind = given.empty() ? "" : given[0];
  std::string kinds;
  if (given == ProgramArguments{"device", kSimulateLog}) return simulate_log_for_pipe();
  for (const auto& [name, sentence, package] : kImportKinds) {
    if (name == kind) return run({package}, {given.begin() + 1, given.end()}, context);
    kinds += layout.entry(fmt::format("hapbench import {} --help", name), sentence, 2, 34);
  }
  if (kind == "-h" || kind == "--help") {
    const std::string text =
        layout.wrapped("Convert a recording into a stroke, or the log of a device into a device file.", 0) +
        "\nUsage: hapbench import stroke [OPTIONS] [<recording>]\n"
        "       hapbench import device [OPTIONS] [<log.csv>]\n\n" +
        kinds + "\n" +
        layout.wrapped(
            "Both write into the current folder, and read any column names with --columns and any units with --scale, "
            "whose factors are SI units per unit of the file (position=1e-3 for mm). A file with invalid rows is "
            "rejected, and nothing is written; --skip-bad-rows skips these rows. A stroke is also rejected for jumps "
            "or gaps: see its help.",
            0) +
        "\nExamples:\n"
        "  hapbench import stroke log.txt --preset hapi\n"
        "  hapbench import stroke rec.csv --columns time=1,position=2 --scale time=1e-6\n"
        "  hapbench import device log.csv\n\n" +
        layout.wrapped("Manual: scenarios/INPUT_FILES.md, section \"Recordings\"", 0);
    print(context, {}, text, {});
    return kSuccess;
  }
  throw InputError(fmt::format("import: {}; allowed: hapbench import stroke FILE, hapbench import device LOG",
                               kind.empty() ? "the kind is missing" : fmt::format("got \"{}\" as the kind", kind)));
}

}  // namespace

void draw_run(ProgramContext& context, const std::filesystem::path& folder, const std::filesystem::path& file,
              bool quiet) {
  const std::string line = launch_line(
      {"hapbench_pictures", "plot"}, {"--quiet", "--y=path", "--out=" + file.string(), "--", folder.string()}, context);
  const WaitNotice notice("drawing", !quiet);
  const int status = run_subprocess(line).first;
  throw_if_stopped();
  if (status != 0) throw IoError("draw what is in", folder, std::make_error_code(std::errc::io_error));
}

int run_python_command(const ProgramArguments& arguments, ProgramContext& context) {
  const ProgramArguments given(arguments.begin() + 1, arguments.end());
  if (arguments[0] == "import") return run_import(given, context);
  if (arguments[0] == "plot" && !given.empty() && given[0] == kRunsWhere) return print_runs_where(given, context);
  if (arguments[0] == "plot" && !given.empty() && given[0] == kKnee) return print_knee(given, context);
  if (arguments[0] == "audit" && !given.empty() && given[0] == kLinearLoop) return print_linear_loop(given, context);
  if (arguments[0] == "audit") return run({"hapbench_audit"}, given, context);
  return run({"hapbench_pictures", arguments[0]}, given, context);
}

}  // namespace hapbench
