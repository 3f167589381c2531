#include "scenarios/batch/result_folders.hpp"

#include <fmt/format.h>

#include <set>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// The results below a folder: summaries of runs and tables of sweeps.
std::set<fs::path> results_below(const fs::path& folder) {
  std::error_code error;
  std::set<fs::path> found;
  if (!fs::is_directory(folder, error)) fail_in_file(folder, "is not a folder; allowed: that of a run, or of several");
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path name = entry->path().filename();
    if (name == "summary.json" || name == "sweep.csv") found.insert(entry->path().lexically_relative(folder));
  }
  if (error) fail_in_file(folder, fmt::format("cannot be read: {}", error.message()));
  if (found.empty()) {
    fail_in_file(folder, "is not the folder of a run: it has no summary.json, nor has any below it");
  }
  return found;
}

}  // namespace

ResultPairs pair_results(const fs::path& a, const fs::path& b) {
  const std::set<fs::path> in_a = results_below(a), in_b = results_below(b);
  ResultPairs pairs;
  for (const fs::path& path : in_a) {
    if (!in_b.contains(path)) {
      pairs.only_in_a.push_back(path);
    } else if (path.filename() == "sweep.csv") {
      pairs.sweeps.push_back(path);
    } else {
      pairs.runs.push_back(path.parent_path());
    }
  }
  for (const fs::path& path : in_b) {
    if (!in_a.contains(path)) pairs.only_in_b.push_back(path);
  }
  if (pairs.empty()) {
    throw InputError(fmt::format(
        "{} has {} and {} has {}, nothing by the same name; allowed: the folders of two runs, or of several each",
        a.string(), in_a.begin()->string(), b.string(), in_b.begin()->string()));
  }
  return pairs;
}

}  // namespace hapbench
