#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// Runs the built programs as a user's shell would, but without a shell: arguments arrive as they are given.
namespace hapbench::test {

/// The exit status and the outputs of a finished process.
struct ProgramRun {
  /// Standard output as JSON; fails the test when it is no JSON.
  Json json() const;

  int status = -1;           ///< exit status; -1 when a signal ended it
  int signal = 0;            ///< the signal that ended it, or 0
  std::string out;           ///< standard output
  std::string err;           ///< standard error
  double cpu_seconds = 0.0;  ///< user and system time: unlike the wall's, the same on a busy machine
};

struct ProgramOptions {
  std::filesystem::path directory = {};  ///< where it runs; empty: here
  bool as_root_may = true;       ///< false: root has no privileges either; status 126 when they cannot be dropped
  std::size_t file_limit = 0;    ///< of each file it writes [bytes]; 0: none
  std::size_t columns = 0;       ///< of the terminal it is told to have; 0: none
  std::size_t memory_limit = 0;  ///< of address space [bytes]; 0: none. Not with sanitizers, which reserve a lot
};

ProgramRun run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                       const ProgramOptions& options = {});

/// The program people run, and the same from the scalar reference build.
std::filesystem::path hapbench_program();
std::filesystem::path hapbench_scalar_program();
/// `hapbench ARGUMENTS…`
ProgramRun hapbench(const std::vector<std::string>& arguments, const ProgramOptions& options = {});

/// The same in this process, for commands that only read and print; a hundredth of the time of a process each.
ProgramRun hapbench_here(const std::vector<std::string>& arguments);

/// A process that goes on while the test does something else; killed, if need be, by the destructor.
class RunningProgram {
 public:
  RunningProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  ~RunningProgram();
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  bool is_running();
  /// Waits, however long it takes, until the condition holds. Returns false when the process ends before.
  bool runs_until(const std::function<bool()>& condition);
  /// SIGKILL, and waits for the end. Returns true when that ended it, false when it had ended before.
  bool kill();
  void send(int signal);
  /// Waits for the end. Returns the exit status, or the negative number of the signal that ended the process.
  int wait();
  /// Sends a signal that the process may handle; waits and returns as wait() does.
  int end_by(int signal);
  /// Returns the text on standard error so far.
  std::string err();

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> err_;
  int process_;
  bool reaped_ = false;
};

}  // namespace hapbench::test
