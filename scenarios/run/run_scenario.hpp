#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "results/record/recorder.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/geometry/point_shell.hpp"

/// A run: what it records, row by row, the directory of its results, and the running itself.
namespace hapbench {

/// From which the recorders of a trial are made.
struct RecordedTrial {
  const RecordFields& fields;
  std::size_t contact_capacity;  ///< the most contacts a row can have
  const SectionObservers& sections;
  const InsideObserver* inside;  ///< null without a solid
};

/// The tables of a trial in memory, by the names that their files would have.
using RecordedTables = std::map<std::string, MemoryTable>;

/// Where a trial is recorded: files in a directory, or tables in memory (never null; they outlive the recorders).
using RecordTarget = std::variant<std::filesystem::path, RecordedTables*>;

using Recorders = std::vector<std::unique_ptr<Recorder>>;

/// Recorders for what the scenario asks for. Throws IoError.
Recorders make_recorders(const RecordedTrial& trial, const RecordTarget& target);

/// The tables of all recorders there are.
std::vector<ResultTable> record_tables();

/// About how many bytes a run of the scenario will write, all trials together: 12 for each number, if every step is
/// done and has 30 contacts. Within a factor of two, but for those. O(1).
double expected_output_bytes(const Scenario& scenario);

/// Creates directories for results, and in the end removes those that are still empty, as failed work leaves them.
class NewDirectories {
 public:
  NewDirectories() = default;
  ~NewDirectories();
  NewDirectories(const NewDirectories&) = delete;
  NewDirectories& operator=(const NewDirectories&) = delete;

  /// Creates a directory and its missing parents; as std::filesystem::create_directories.
  std::error_code create(const std::filesystem::path& directory);

 private:
  std::vector<std::filesystem::path> made_;  ///< parents first
};

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

/// What a run would have written, in memory.
struct RunTables {
  std::vector<RecordedTables> trials;
  std::optional<MemoryTable> targets;  ///< targets.csv, of a tracking hand
  Json effective;                      ///< scenario.effective.json, with paths from the working directory

  /// Ends the recorders, and adds what is not of one trial. Throws std::bad_alloc when rows were lost.
  void write(const Json& of_scenario, const Result& result, const Recorders& recorders);
};

/// Removes from a directory, if there is one, only what a run wrote. Throws IoError when it cannot be listed.
void remove_run(const std::filesystem::path& directory);

/// Runs a scenario, all its trials one after the other. With `output`, writes summary.json, scenario.effective.json and
/// what the scenario records into that directory (ResultFolder), records of several trials into a subdirectory each.
/// With `tables`, and without a directory, what the scenario records goes there. Without either, the summary has no
/// provenance and no scenario hash. `progress` allows a progress bar. `diagnose`: the result says what is wrong with
/// the run (diagnosis.hpp), for some 20 ns a row. Throws InputError for files it cannot use (before anything is
/// written), IoError when writing fails, Stopped when a signal ends the run: then nothing of it is left. `shell`, if it
/// is there already: make_shell of the scenario, which several runs, also at once, may share.
Result run_scenario(const LoadedScenario& loaded, const std::optional<std::filesystem::path>& output, bool progress,
                    RunTables* tables = nullptr, bool diagnose = false, std::shared_ptr<const PointShell> shell = {});

/// The same for its result alone.
inline Result run_with_shell(const LoadedScenario& loaded, const std::shared_ptr<const PointShell>& shell) {
  return run_scenario(loaded, {}, false, nullptr, false, shell);
}

/// The expectations of the scenario that the run does not meet, one sentence each.
std::vector<std::string> unmet_expectations(const ExpectFields& expect, const Result& run);

/// True when `outcome` is among those the scenario expects.
inline bool outcome_is_expected(const ExpectFields& expect, Outcome outcome) {
  return std::ranges::find(expect.outcomes, outcome) != expect.outcomes.end();
}

}  // namespace hapbench
