#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/jobs.hpp"

/// Checks a sweep before its first run: the scenarios that it loads, the files that they name, its columns.
namespace hapbench {

/// Cases to run, checked before the first run.
struct SweepPlan {
  Cases cases;
  std::vector<std::string> warnings = {};  ///< of the runs that were checked, without duplicates
  std::vector<std::string> metrics = {};   ///< that some of these runs have
  std::vector<std::string> bounded = {};   ///< those of the metrics whose rows say by how much they may be wrong
  /// Everything that determines the rows: scenes, overrides, points, hashes of the files the scenarios name, program.
  Json content = {};
  std::string definition = {};  ///< FNV-1a of the content, as 16 hexadecimal digits
};

/// Maximum number of runs of a sample, and of values of a field of a grid, that are checked before the first run.
inline constexpr std::size_t kMostChecked = 1000;

/// The runs that are checked, in order: all of at most kMostChecked. Of a larger grid those at its edges through the
/// first and the last run, along each of which one field takes its values (at most kMostChecked of them, the ends
/// included); of a larger sample the first.
std::vector<std::size_t> runs_to_check(const Cases& cases);

/// Loads the scenarios of the runs to check and reads the files they name, to find errors before anything is run or
/// written; some 0.1 ms a run and thread. Throws InputError, that of the run with the lowest number, and Stopped.
SweepPlan plan_sweep(Cases cases, const JobOptions& jobs);

}  // namespace hapbench
