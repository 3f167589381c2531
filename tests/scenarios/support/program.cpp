#include "tests/scenarios/support/program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/securebits.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <regex>
#include <stdexcept>
#include <thread>

#include "scenarios/program/run_program.hpp"
#include "tests/results/files.hpp"

namespace hapbench::test {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// Returns a temporary file without a name. Unlike a pipe, it never blocks the process that writes.
File nameless_file() {
  File file(std::tmpfile(), std::fclose);
  if (!file) throw std::runtime_error("no temporary file");
  return file;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

std::string contents(std::FILE* file) {
  std::string text;
  std::rewind(file);
  char piece[1 << 14];
  for (std::size_t n; (n = std::fread(piece, 1, sizeof piece, file)) > 0;) text.append(piece, n);
  return text;
}

/// Returns standard error without progress lines, which depend on the speed of the machine.
std::string without_progress(const std::string& err) {
  static const std::regex kProgress("[^\\n]*( \\.\\.\\. \\d+ s|: +\\d+ %[^\\n]*)\\n");
  return std::regex_replace(err, kProgress, "");
}

/// Starts a process. Between fork() and exec(), only async-signal-safe functions are called; all strings are
/// created before.
pid_t start(const std::filesystem::path& program, const std::vector<std::string>& arguments,
            const ProgramOptions& options, int out, int err) {
  std::vector<std::string> strings = {program.string()};
  strings.insert(strings.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& string : strings) argv.push_back(string.data());
  argv.push_back(nullptr);
  const std::string directory = options.directory.string();

  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child > 0) return child;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // the process ends together with a test that is killed after a time-out
  const int null = ::open("/dev/null", O_RDONLY);
  ::dup2(null, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  if (options.memory_limit != 0) {
    const rlimit limit{options.memory_limit, options.memory_limit};
    ::setrlimit(RLIMIT_AS, &limit);
  }
  if (options.file_limit != 0) {
    const rlimit limit{options.file_limit, options.file_limit};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  if (!options.as_root_may && ::geteuid() == 0 && ::prctl(PR_SET_SECUREBITS, SECBIT_NOROOT) != 0) ::_exit(126);
  // Shells start background processes with SIGINT ignored.
  ::signal(SIGINT, SIG_DFL);
  if (!directory.empty() && ::chdir(directory.c_str()) != 0) ::_exit(127);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

}  // namespace

Json ProgramRun::json() const {
  Json json = Json::parse(out, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << "no JSON: " << out << err;
  return json;
}

ProgramRun run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                       const ProgramOptions& options) {
  const std::optional<std::string> columns =
      options.columns == 0 ? std::nullopt : std::optional(std::to_string(options.columns));
  const EnvironmentVariable width("COLUMNS", columns);
  const File out = nameless_file(), err = nameless_file();
  const pid_t child = start(program, arguments, options, ::fileno(out.get()), ::fileno(err.get()));
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  ProgramRun run;
  run.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  if (WIFEXITED(status)) run.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
  run.out = contents(out.get());
  run.err = without_progress(contents(err.get()));
  return run;
}

std::filesystem::path hapbench_program() {
  return HAPBENCH_PROGRAM;
}

std::filesystem::path hapbench_scalar_program() {
  return HAPBENCH_SCALAR_PROGRAM;
}

ProgramRun hapbench(const std::vector<std::string>& arguments, const ProgramOptions& options) {
  return run_program(hapbench_program(), arguments, options);
}

ProgramRun hapbench_in_process(const std::vector<std::string>& arguments) {
  ProgramContext context{.program = hapbench_program()};
  ProgramRun run;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  run.status = run_program_to_exit(arguments, context);
  std::fflush(stdout);
  run.out = testing::internal::GetCapturedStdout();
  run.err = without_progress(testing::internal::GetCapturedStderr());
  return run;
}

RunningProgram::RunningProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments)
    : err_(nameless_file()) {
  const int err = ::fileno(err_.get());
  ::fcntl(err, F_SETFL, O_APPEND);  // append, because err() moves the file offset, which the process shares
  const int null = ::open("/dev/null", O_WRONLY);
  process_ = start(program, arguments, {}, null, err);
  ::close(null);
}

RunningProgram::~RunningProgram() {
  kill();
}

bool RunningProgram::is_running() {
  if (!reaped_ && ::waitpid(process_, nullptr, WNOHANG) == process_) reaped_ = true;
  return !reaped_;
}

bool RunningProgram::runs_until(const std::function<bool()>& condition) {
  while (!condition()) {
    if (!is_running()) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  return true;
}

void RunningProgram::send(int signal) {
  if (reaped_) throw std::logic_error("the process has ended");
  ::kill(process_, signal);
}

int RunningProgram::wait() {
  int status = 0;
  ::waitpid(process_, &status, 0);
  reaped_ = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

int RunningProgram::end_by(int signal) {
  send(signal);
  return wait();
}

bool RunningProgram::kill() {
  if (reaped_) return false;
  ::kill(process_, SIGKILL);
  return wait() == -SIGKILL;
}

std::string RunningProgram::err() {
  return contents(err_.get());
}

}  // namespace hapbench::test
