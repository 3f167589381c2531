#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <utility>

#include "results/summary/summary.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/folder_lock.hpp"
#include "scenarios/run/new_directories.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"

namespace hapbench {

/// Directory to which a run writes its results.
struct RunOutput {
  RunOutput(std::filesystem::path folder, bool has_lock = false)  // NOLINT: implicit on purpose
      : directory(std::move(folder)), is_locked(has_lock) {}

  std::filesystem::path directory;
  bool is_locked;  ///< true if the caller has excluded other writers by a FolderLock
};

/// The directory of a run's results, protected by a lock (folder_lock.hpp): no other process or thread can create a
/// ResultFolder for the same directory while this object exists.
class ResultFolder {
 public:
  /// Creates the directory, and locks it unless the caller has locked it (RunOutput::is_locked). The destructor removes
  /// created directories that are still empty. Throws IoError if the directory cannot be created or another run holds
  /// the lock.
  explicit ResultFolder(const RunOutput& output);

  /// Creates and returns the directory into which a trial records. `trials`: number of trials of the run; for a
  /// single trial, this is the run's directory. Throws IoError.
  std::filesystem::path trial_directory(Trial trial, std::size_t trials);

  /// Writes the results and replaces the results of an earlier run. Each file appears complete or not at all;
  /// the summary appears last. Returns true if the earlier results were of another scenario. `effective`:
  /// scenario.effective.json, with paths relative to the directory. Throws IoError.
  bool write(const RecordFields& record, const Json& effective, const Result& result, const Recorders& recorders);

 private:
  std::filesystem::path directory_;
  NewDirectories directories_;
  std::optional<FolderLock> lock_;  ///< empty if the caller holds a lock
};

/// Removes the files in `directory` that an earlier run wrote, and keeps all other files. Does nothing if the directory
/// does not exist. Throws IoError if the directory cannot be listed.
void remove_run(const std::filesystem::path& directory);

}  // namespace hapbench
