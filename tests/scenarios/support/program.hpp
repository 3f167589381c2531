#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// Runs the built programs like a user's shell, but passes arguments unchanged.
namespace hapbench::test {

/// The exit status and the outputs of a finished process.
struct ProgramRun {
  /// Returns standard output as JSON. Fails the test if it is not JSON.
  Json json() const;

  int status = -1;  ///< exit status; -1 if a signal terminated the process
  int signal = 0;   ///< signal that terminated the process, or 0
  std::string out;  ///< standard output
  std::string err;  ///< standard error
  /// User and system time [s]; unlike wall time, it hardly depends on the load of the machine.
  double cpu_seconds = 0.0;
};

struct ProgramOptions {
  std::filesystem::path directory = {};  ///< working directory; empty: the current directory
  /// If false and the test runs as root, the process drops root's privileges. If it cannot drop them, its exit status
  /// is 126.
  bool as_root_may = true;
  std::size_t file_limit = 0;  ///< maximum size of each written file [bytes]; 0: no limit
  std::size_t columns = 0;     ///< number of columns of the terminal that the process sees; 0: not set
  /// Maximum address space [bytes]; 0: no limit. Do not use with sanitizers, because they reserve a large address
  /// space.
  std::size_t memory_limit = 0;
};

/// Runs a program to its end.
ProgramRun run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                       const ProgramOptions& options = {});

/// Returns the paths of the normal program and of the reference build without SIMD.
std::filesystem::path hapbench_program();
std::filesystem::path hapbench_scalar_program();
/// Runs `hapbench ARGUMENTS…`.
ProgramRun hapbench(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

/// Runs a command of hapbench in this process. For commands that only read and print; about 100 times faster
/// than a new process.
ProgramRun hapbench_in_process(const std::vector<std::string>& arguments);

/// A process that runs while the test continues. The destructor kills it if it is still running.
class RunningProgram {
 public:
  RunningProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Returns true if the process has not ended.
  bool is_running();
  /// Waits until the condition holds, without a time limit. Returns false if the process ends first.
  bool runs_until(const std::function<bool()>& condition);
  /// Sends SIGKILL and waits for the end. Returns true if the signal terminated the process, false if it had
  /// already ended.
  bool kill();
  /// Sends a signal.
  void send(int signal);
  /// Waits for the end. Returns the exit status, or the negative number of the signal that terminated the
  /// process.
  int wait();
  /// Sends a signal that the process may handle. Waits and returns like wait().
  int end_by(int signal);
  /// Returns what the process has written to standard error so far.
  std::string err();

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> err_;
  int process_;
  bool reaped_ = false;
};

}  // namespace hapbench::test
