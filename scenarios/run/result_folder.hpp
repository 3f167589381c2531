#pragma once

#include <map>
#include <optional>
#include <variant>

#include "results/record/recorder.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/format/parts.hpp"

/// What a run records, row by row, and the directory of its results.
namespace hapbench {

/// Data from which the recorders of a trial are made.
struct RecordedTrial {
  const RecordFields& fields;
  std::size_t contact_capacity;  ///< the most contacts a row can have
  const SectionObservers& sections;
  const InsideObserver* inside;  ///< null without a solid
};

/// The tables of a trial in memory, by the names that their files would have.
using RecordedTables = std::map<std::string, MemoryTable>;

/// The destination of the recorders of a trial: files in a directory, or tables in memory (never null; they must
/// outlive the recorders).
using RecordTarget = std::variant<std::filesystem::path, RecordedTables*>;

using Recorders = std::vector<std::unique_ptr<Recorder>>;

/// Recorders for what the scenario asks for. Throws IoError.
Recorders make_recorders(const RecordedTrial& trial, const RecordTarget& target);

/// The tables of all recorders there are.
std::vector<ResultTable> record_tables();

/// About how many bytes a run of the scenario will write [bytes]: rows times columns times 12 of what it records, all
/// trials together. An upper estimate of the rows: every step is done, and for contacts.csv 30 contacts are in each of
/// them. Sizes known beforehand are within a factor of two; that of contacts.csv is a guess. O(1).
double expected_output_bytes(const Scenario& scenario);

/// Creates directories for results. Its destructor removes those that are still empty, so that failed or stopped work
/// leaves none behind.
class NewDirectories {
 public:
  NewDirectories() = default;
  ~NewDirectories();
  NewDirectories(const NewDirectories&) = delete;
  NewDirectories& operator=(const NewDirectories&) = delete;

  /// Creates a directory and its missing parents; `error` as of std::filesystem::create_directories.
  void create(const std::filesystem::path& directory, std::error_code& error);

 private:
  std::vector<std::filesystem::path> made_;  ///< parents first
};

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
  /// last. Returns true when that was another scenario. Throws IoError.
  bool write(const RecordFields& record, const WrittenScenario& scenario, const Result& result,
             const Recorders& recorders);

 private:
  std::filesystem::path directory_;
  NewDirectories directories_;
  int descriptor_ = -1;  ///< of the lock
};

/// What a run would have written, in memory.
struct RunTables {
  std::vector<RecordedTables> trials;
  std::optional<MemoryTable> targets;  ///< targets.csv, of a tracking hand
  Json effective;                      ///< scenario.effective.json, with paths from the working directory

  /// Ends the recorders, and adds what is not of one trial. Throws std::bad_alloc when rows were lost.
  void write(const WrittenScenario& scenario, const Result& result, const Recorders& recorders);
};

/// Removes the files that a run wrote into a directory, if it is there, and leaves all others. Throws IoError when the
/// directory cannot be listed.
void remove_run(const std::filesystem::path& directory);

}  // namespace hapbench
