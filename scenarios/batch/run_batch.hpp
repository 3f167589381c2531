#pragma once

#include <filesystem>
#include <vector>

#include "scenarios/batch/batch_plan.hpp"
#include "scenarios/run/run_scenario.hpp"

namespace hapbench {

struct BatchOptions {
  std::filesystem::path directory;  ///< of all files; exists
  std::size_t jobs = 1;             ///< runs at once
  bool progress = false;            ///< allow a progress bar
};

struct BatchReport {
  std::vector<RunReport> runs;  ///< by number
};

/// Does the runs of a plan, `jobs` at once, runs in one environment sharing its shell, and writes the files of each
/// into its directory. Files do not depend on `jobs`. However a run ends, the others go on; SIGINT and SIGTERM end the
/// batch after the runs in flight. Throws IoError when something cannot be written.
BatchReport run_batch(const BatchPlan& plan, const BatchOptions& options);

}  // namespace hapbench
