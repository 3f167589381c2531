#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"

namespace hapbench {

/// Cases to run, checked before the first run.
struct SweepPlan {
  Cases cases;

  std::vector<std::string> warnings;  ///< of the runs that were checked, without duplicates
  std::vector<std::string> metrics;   ///< that some of these runs have
  std::vector<std::string> bounded;   ///< those of the metrics whose rows say by how much they may be wrong
  /// Everything that determines the rows: scenes, overrides, points, hashes of the files the scenarios name, program.
  Json content;
  std::string definition;  ///< FNV-1a of the content, as 16 hexadecimal digits

  /// The names of the columns of the table (sweep_table.hpp).
  std::vector<std::string> columns() const;
  /// The JSON file beside the table of a shard, which says what it is about.
  Json description(const Shard& shard) const;
};

/// Maximum number of runs of a sample, and of values of a field of a grid, that are checked before the first run.
inline constexpr std::size_t kMostChecked = 1000;

/// The runs that are checked, in order: all if there are at most kMostChecked. Of a larger grid, the runs at the edges
/// through its first and its last run, along each of which one field takes all its values (at most kMostChecked of
/// them, the ends included). Of a larger sample, the first runs.
std::vector<std::size_t> runs_to_check(const Cases& cases);

/// Loads the scenarios of the runs to check and reads the files they name, to find errors before anything is run or
/// written. Takes about 0.1 ms for each run on each of `jobs` threads. `progress` allows a progress bar. Throws
/// InputError, that of the run with the lowest number if there are several.
SweepPlan plan_sweep(Cases cases, std::size_t jobs, bool progress);

}  // namespace hapbench
