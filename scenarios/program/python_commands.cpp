#include "scenarios/program/python_commands.hpp"

#include <fmt/format.h>
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
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/exit_status.hpp"
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
    {"stroke", "Make a stroke to play back from a recording: poses and measured forces", "hapbench_import"},
    {"device", "Make a device's file from its log: mass, friction, delay, encoder", "hapbench_identify"}};

/// The line of a shell that becomes the launcher, which finds a Python for the package: its name and its first words.
std::string launch_line(const ProgramWords& package, const ProgramWords& given, ProgramContext& context) {
  ProgramWords words = {"exec", (installed_folder("scripts/python") / "launch").string()};
  words.insert(words.end(), package.begin(), package.end());
  words.insert(words.end(), given.begin(), given.end());
  // The packages ask this very program, for the points of a scene.
  setenv("HAPBENCH_PROGRAM", context.program.c_str(), 1);
  return shell_line(words);
}

[[noreturn]] void fail_to_launch() {
  throw IoError("run the Python of hapbench's source tree,", "scripts/python/launch",
                std::error_code(errno, std::generic_category()));
}

/// Runs the line as another process. Returns its exit status and what it printed on standard output.
std::pair<int, std::string> run_beside(const std::string& line) {
  std::fflush(stdout);
  std::FILE* pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) fail_to_launch();
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  const int ended = ::pclose(pipe);
  return {WIFEXITED(ended) ? WEXITSTATUS(ended) : kStopped + WTERMSIG(ended), text};
}

/// Runs it for the host, which gets text and messages. Returns its exit status. Throws InputError for what it refuses.
int run_for(CapturedOutput& host, const std::string& line) {
  const auto [status, text] = run_beside(line + " 2>&1");
  constexpr std::string_view kError = "hapbench: error: ", kWarning = "hapbench: warning: ";
  std::vector<InputError> faults;
  LineReader lines(text);
  while (const auto said = lines.next()) {
    if (said->starts_with(kError)) {
      faults.emplace_back(std::string(said->substr(kError.size())));
    } else if (said->starts_with(kWarning)) {
      host.warnings.emplace_back(said->substr(kWarning.size()));
    } else if (!said->starts_with("hapbench: ")) {  // how long it takes is for people
      host.text.append(*said).append("\n");
    }
  }
  if (status == kBadInput && !faults.empty()) throw InputError::all(faults);
  for (const InputError& fault : faults) host.errors.emplace_back(fault.what());
  return status;
}

/// Makes "hapbench import device" simulate a log for its own Python, thousands of times over a pipe of doubles.
/// Standard input has the count of rows, their times, their forces, and then requests: a number of rows (0 ends it) and
/// the fields of a LoggedHandle. Each answer on standard output is the positions at these rows.
constexpr const char* kSimulateLog = "--simulate-log";

int simulate_log_for_pipe() {
  const auto read = [](double* values, std::size_t count) {
    return std::fread(values, sizeof(double), count, stdin) == count;
  };
  double rows = 0.0;
  if (!read(&rows, 1) || !(rows >= 0.0 && rows < 1e9)) return kBadInput;
  std::vector<double> times(static_cast<std::size_t>(rows)), forces(times.size()), positions(times.size());
  if (!read(times.data(), times.size()) || !read(forces.data(), forces.size())) return kBadInput;
  std::array<double, 7> asked{};
  while (read(asked.data(), asked.size()) && asked[0] > 0.0 && asked[0] <= rows) {
    const auto count = static_cast<std::size_t>(asked[0]);
    const LoggedHandle handle{asked[1], asked[2], asked[3], asked[4], asked[5], asked[6]};
    simulate_log(handle, std::span(times).first(count), std::span(forces).first(count), positions);
    if (std::fwrite(positions.data(), sizeof(double), count, stdout) != count || std::fflush(stdout) != 0) break;
  }
  return kSuccess;
}

/// Blocks Ctrl-C until the Python of the command answers it (stop_on_ctrl_c in hapbench_command.py). A blocked signal
/// stays pending across exec. Otherwise the shell would lose the signal, or Python would print a traceback of its
/// imports. Throws Stopped if the signal came before.
void leave_ctrl_c_to_python() {
  sigset_t ctrl_c;
  sigemptyset(&ctrl_c);
  sigaddset(&ctrl_c, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &ctrl_c, nullptr);
  throw_if_stopped();
}

/// At a terminal this process becomes the launcher.
int run(const ProgramWords& package, const ProgramWords& given, ProgramContext& context) {
  const std::string line = launch_line(package, given, context);
  if (context.captured != nullptr) return run_for(*context.captured, line);
  leave_ctrl_c_to_python();
  ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
  fail_to_launch();
}

int run_import(const ProgramWords& given, ProgramContext& context) {
  const Layout layout = context.layout();
  const std::string kind = given.empty() ? "" : given[0];
  std::string kinds;
  if (given == ProgramWords{"device", kSimulateLog}) return simulate_log_for_pipe();
  for (const auto& [name, sentence, package] : kImportKinds) {
    if (name == kind) return run({package}, {given.begin() + 1, given.end()}, context);
    kinds += layout.entry(fmt::format("hapbench import {} --help", name), sentence, 2, 34);
  }
  if (kind == "-h" || kind == "--help") {
    print(context, {}, "Usage: hapbench import stroke FILE | hapbench import device LOG\n\n" + kinds, {});
    return kSuccess;
  }
  throw InputError(fmt::format("import: {}; allowed: hapbench import stroke FILE, hapbench import device LOG",
                               kind.empty() ? "the kind is missing" : fmt::format("got \"{}\" as the kind", kind)));
}

}  // namespace

void write_way(ProgramContext& context, const std::filesystem::path& folder, const std::filesystem::path& file,
               bool quiet) {
  const std::string line = launch_line(
      {"hapbench_pictures", "plot"}, {"--quiet", "--y=path", "--out=" + file.string(), "--", folder.string()}, context);
  const WaitNotice notice("drawing", !quiet);
  const int status = run_beside(line).first;
  throw_if_stopped();
  if (status != 0) throw IoError("draw what is in", folder, std::make_error_code(std::errc::io_error));
}

int run_python_command(const ProgramWords& words, ProgramContext& context) {
  const ProgramWords given(words.begin() + 1, words.end());
  return words[0] == "import" ? run_import(given, context)
                              : run({"hapbench_pictures", words[0]}, given, context);
}

}  // namespace hapbench
