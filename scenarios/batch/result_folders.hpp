#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hapbench {

/// The files that a command with several runs writes into a directory, by relative paths.
struct ResultList {
  std::vector<std::filesystem::path> runs;    ///< directories of runs
  std::vector<std::filesystem::path> tables;  ///< other files
};

/// The file in which a command keeps its list.
inline constexpr const char* kResultListFile = "hapbench_results.json";

/// Removes from `directory` the results of an earlier command, which are listed in kResultListFile, and replaces that
/// list by `now`. Call it before the first run. Removes all listed tables, and the listed runs that `now` does not
/// name: their result files (remove_run), and their directories if these are empty afterwards. Ignores entries that
/// lead out of `directory`, by ".." or a link, and a list that cannot be read. Throws IoError when the new list cannot
/// be written.
void replace_earlier_results(const std::filesystem::path& directory, const ResultList& now);

/// Removes the list if none of the files it names exists, for instance after a command was stopped in its first run.
void forget_results_if_none(const std::filesystem::path& directory);

}  // namespace hapbench
