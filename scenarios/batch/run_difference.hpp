#pragma once

#include <optional>

#include "scenarios/batch/table_difference.hpp"

namespace hapbench {

/// A value of two JSON files that is not the same.
struct NamedDifference {
  std::string name;  ///< dots lead into sections, as in --set
  CellDifference values;
};

/// How the results of two runs differ.
struct RunDifference {
  std::vector<NamedDifference> fields;   ///< of scenario.effective.json; files that it names, by their contents
  std::vector<NamedDifference> metrics;  ///< outcome, steps and numbers of summary.json
  std::vector<std::string> unshared;     ///< metrics that one summary alone knows, "> name" of the second
  std::string state_hash_a, state_hash_b;
  std::optional<TableDifference> trajectory;  ///< when both recorded one
  bool trajectory_missing = false;            ///< one alone recorded one

  /// The results, not the fields, differ by more than the tolerance: an outcome, a metric relative to the larger of the
  /// two, the trajectory, or, with a tolerance of 0, the state hash. What one alone knows does not count, a trajectory
  /// that one alone has does.
  bool is_beyond(double tolerance) const;
};

/// Compares the folders of two runs. Provenance, times and counted work are no results and are not looked at. Throws
/// InputError when a file cannot be used.
RunDifference compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace hapbench
