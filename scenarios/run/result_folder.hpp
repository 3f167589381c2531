#pragma once

#include <filesystem>

#include "results/io/atomic_file.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {

/// The directory of a run's results. While one object holds it, another cannot be made, in any process, so that two
/// runs do not write into one folder. File systems without locks are not guarded.
class ResultFolder {
 public:
  /// Creates the directory; it and those of trials leave again if they are still empty in the end. Throws IoError, also
  /// when another run holds the directory.
  explicit ResultFolder(const std::filesystem::path& directory);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Creates the directory into which a trial records: this one when the trial is the only one of `trials`. Throws
  /// IoError.
  std::filesystem::path of_trial(Trial trial, std::size_t trials);

  /// Writes the results in place of those of an earlier run: each file appears complete or not at all, the summary
  /// last. Throws IoError.
  void write(const RecordFields& record, const WrittenScenario& scenario, const Result& result,
             const Recorders& recorders);

 private:
  std::filesystem::path directory_;
  NewDirectories directories_;
  int descriptor_ = -1;  ///< of the lock
};

/// Removes the files that a run wrote into a directory, if it is there, and leaves all others. Throws IoError when the
/// directory cannot be listed.
void remove_run(const std::filesystem::path& directory);

}  // namespace hapbench
