#pragma once

#include <filesystem>
#include <vector>

namespace hapbench {

/// What two folders of results have in common, by paths from there; empty for the folder itself.
struct ResultPairs {
  std::vector<std::filesystem::path> runs;    ///< folders with a summary.json
  std::vector<std::filesystem::path> sweeps;  ///< tables of sweeps, sweep.csv
  std::vector<std::filesystem::path> only_in_a, only_in_b;

  bool empty() const { return runs.empty() && sweeps.empty(); }
};

/// Looks through both folders, in the order of names. Throws InputError when one cannot be read, holds no result, or
/// shares none with the other.
ResultPairs pair_results(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace hapbench
