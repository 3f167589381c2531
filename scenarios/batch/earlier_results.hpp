#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hapbench {

/// What a command that runs several things writes into one directory, by paths from there.
struct ResultList {
  std::vector<std::filesystem::path> runs;    ///< directories of runs
  std::vector<std::filesystem::path> tables;  ///< other files
};

/// The file that keeps the list of the last command.
inline constexpr const char* kResultListFile = "hapbench_results.json";

/// Removes from `directory` what the list in kResultListFile says an earlier command wrote there and `now` does not
/// name, its tables in any case, and replaces that list by `now`; to be called before anything is run. Nothing else is
/// touched: of a run's directory its result files go (remove_run), and the directory if it is empty then. Entries that
/// lead out of `directory`, by ".." or a link, are passed over, as is a list that cannot be read. Throws IoError when
/// the new list cannot be written.
void replace_earlier_results(const std::filesystem::path& directory, const ResultList& now);

/// Removes the list when nothing of what it names is there, as after a command that was stopped in its first run.
void forget_results_if_none(const std::filesystem::path& directory);

}  // namespace hapbench
