#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "results/summary/summary.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/new_directories.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"

namespace hapbench {

/// The directory of a run's results. While one object holds it, another cannot be made, in any process, so that two
/// runs do not write into one folder. File systems without locks are not guarded.
class ResultFolder {
 public:
  /// Creates the directory; it and those of trials leave if empty in the end. Throws IoError, also when a run holds it.
  explicit ResultFolder(const std::filesystem::path& directory);

  /// Creates the directory into which one of `trials` records: this one for a single trial. Throws IoError.
  std::filesystem::path of_trial(Trial trial, std::size_t trials);

  /// Writes the results in place of those of an earlier run: each file appears complete or not at all, the summary
  /// last. Returns true when that was another scenario. `effective`: with paths from the directory. Throws IoError.
  bool write(const RecordFields& record, const Json& effective, const Result& result, const Recorders& recorders);

 private:
  std::filesystem::path directory_;
  NewDirectories directories_;
  std::shared_ptr<void> lock_;  ///< closes the descriptor that holds the lock
};

/// Removes from a directory, if there is one, only what a run wrote. Throws IoError when it cannot be listed.
void remove_run(const std::filesystem::path& directory);

}  // namespace hapbench
