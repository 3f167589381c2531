#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/outcome.hpp"

/// Checks a sweep before its first run: its scenarios, the files that they name, and its columns.
namespace hapbench {

/// Cases to run, checked before the first run.
struct SweepPlan {
  Cases cases;
  RunLength length = RunLength::full;      ///< whether runs end at a failure
  std::vector<std::string> warnings = {};  ///< warnings of the file of points and of the checked runs, each once
  std::vector<std::string> metrics = {};   ///< metrics that at least one checked run has
  std::vector<std::string> bounded = {};   ///< metrics that have an error bound (tolerance)
  /// Everything that determines the rows: scenes, overrides, points, hashes of the files that the scenarios
  /// name, and the program.
  Json content = {};
  std::string definition = {};  ///< FNV-1a hash of the content, as 16 hexadecimal digits
};

/// Maximum number of runs of a sample, and of values of a field of a grid, that are checked before the first run.
inline constexpr std::size_t kMaxChecked = 1000;

/// Returns the runs to check before the first run, in increasing order. If there are at most kMaxChecked runs, these
/// are all runs. Of a larger sample, they are the first kMaxChecked runs. Of a larger grid, they are the runs
/// that differ from the run with the lowest number, or from the run with the highest number, in at most one field. For
/// each field and each of these two runs, at most kMaxChecked runs are returned, including both ends of the field.
std::vector<std::size_t> runs_to_check(const Cases& cases);

/// Loads the scenarios of the runs to check and reads the files that they name, so that errors are found before
/// anything is run or written. Cost: about 0.1 ms a run, divided by the number of threads. Throws the
/// InputError of the run with the lowest number, and Stopped.
SweepPlan plan_sweep(Cases cases, const JobOptions& jobs, RunLength length = RunLength::full);

/// Returns true if the field "expect" applies to a run of a batch: the scenario has the field and no override changes
/// the run, or an override sets the field. In all other runs, any outcome is a result of the batch and not an error
/// (load_scenario()).
bool states_expectations(const Cases& cases, std::size_t run);

}  // namespace hapbench
