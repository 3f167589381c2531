#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

/// Commands whose work packages in Python do, which take every word behind the name, --help included.
namespace hapbench {
namespace {

using ProgramWords = std::vector<std::string>;

struct PythonCommand {
  const char *name, *sentence;
  ProgramWords words;  ///< for scripts/python/launch: the package, and what it takes before the user's words
};

const PythonCommand kPythonCommands[] = {
    {"import", "Make a stroke to play back from a recording: poses and measured forces", {"hapbench_import"}},
    {"identify", "Make a device's file from its log: mass, friction, delay, encoder", {"hapbench_identify"}},
    {"plot", "Draw runs over time and in space, a sweep, limits", {"hapbench_pictures", "plot"}},
    {"report",
     "Write a page of runs: curves, replay with sound, metrics, scenario, commands",
     {"hapbench_pictures", "report"}}};

/// A command line of the launcher, which finds a Python that has what the package needs.
class Launch {
 public:
  Launch(const ProgramWords& package, const ProgramWords& given)
      : words_{(installed_folder("scripts/python") / "launch").string()} {
    words_.insert(words_.end(), package.begin(), package.end());
    words_.insert(words_.end(), given.begin(), given.end());
    for (std::string& word : words_) pointers_.push_back(word.data());
    pointers_.push_back(nullptr);
    // The packages ask this very program, for the points of a scene.
    setenv("HAPBENCH_PROGRAM", this_program().c_str(), 1);
  }
  Launch(const Launch&) = delete;
  Launch& operator=(const Launch&) = delete;

  /// This process becomes the launcher; returns only by an exception.
  int become() {
    ::execv(pointers_[0], pointers_.data());
    fail(errno);
  }
  /// Starts it beside this process; returns its id.
  pid_t start() {
    std::fflush(stdout);
    pid_t process = 0;
    if (const int error = posix_spawn(&process, pointers_[0], nullptr, nullptr, pointers_.data(), environ)) fail(error);
    return process;
  }
  /// Runs it for the host, which gets what it prints on standard output as text, and its other lines as what they are.
  /// Returns its exit status. Throws an InputError for what it refuses.
  int run_for(CapturedOutput& host) {
    std::FILE* pipe = ::popen((shell_line(words_) + " 2>&1").c_str(), "r");
    if (pipe == nullptr) fail(errno);
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    const int ended = ::pclose(pipe), status = WIFEXITED(ended) ? WEXITSTATUS(ended) : kStopped + WTERMSIG(ended);
    constexpr std::string_view kError = "hapbench: error: ", kWarning = "hapbench: warning: ";
    std::vector<InputError> faults;
    LineReader lines(text);
    while (const auto line = lines.next()) {
      if (line->starts_with(kError)) {
        faults.emplace_back(std::string(line->substr(kError.size())));
      } else if (line->starts_with(kWarning)) {
        host.warnings.emplace_back(line->substr(kWarning.size()));
      } else {
        host.text.append(*line).append("\n");
      }
    }
    if (status == kBadInput && !faults.empty()) throw InputError::all(faults);
    for (const InputError& fault : faults) host.errors.emplace_back(fault.what());
    return status;
  }

 private:
  [[noreturn]] void fail(int error) const {
    throw IoError("run the Python of hapbench's source tree,", words_[0],
                  std::error_code(error, std::generic_category()));
  }

  ProgramWords words_;
  std::vector<char*> pointers_;  ///< as exec takes them
};

int run(const PythonCommand& command, const ProgramWords& given) {
  for (const std::string& word : given) refuse_old_word(command.name, word);
  Launch launch(command.words, given);
  CapturedOutput* host = captured_output();
  return host == nullptr ? launch.become() : launch.run_for(*host);
}

}  // namespace

void write_way(const std::filesystem::path& folder, const std::filesystem::path& file, bool quiet) {
  Launch launch({"hapbench_pictures", "plot"},
                {"--quiet", "--y=path", "--out=" + file.string(), "--", folder.string()});
  const pid_t process = launch.start();
  const WaitNotice notice("drawing", !quiet);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  throw_if_stopped();
  if (status != 0) throw IoError("draw what is in", folder, std::make_error_code(std::errc::io_error));
}

void add_python_commands(CommandLine& line) {
  for (const PythonCommand& command : kPythonCommands)
    line.pass_on(command.name, command.sentence, [&command](const ProgramWords& given) { return run(command, given); });
}

}  // namespace hapbench
