#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::test {

/// A Slurm cluster of one node with four CPUs, this machine, with daemons, ports, key and folder of its own; while it
/// lives the environment names it (SLURM_CONF), and with it the daemons go, also when the test is killed.
class SlurmCluster {
 public:
  /// What is missing to start one; empty: nothing.
  static std::string missing();

  /// Precondition: nothing is missing. Throws std::runtime_error when the daemons do not answer.
  SlurmCluster();
  /// Cancels what still runs.
  ~SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  /// Runs one of Slurm's commands.
  ProgramRun operator()(const std::string& command, const std::vector<std::string>& arguments) const;

  /// What the daemons logged, for a test that failed.
  std::string logs() const;

 private:
  void write_configuration() const;
  void start(const std::vector<std::string>& words);

  TemporaryDirectory directory_;
  std::vector<std::unique_ptr<RunningProgram>> daemons_;
};

}  // namespace hapbench::test
