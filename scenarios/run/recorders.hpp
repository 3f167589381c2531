#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "results/observe/inside_observer.hpp"
#include "results/record/recorder.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/scenario.hpp"

/// Recorders that write the tables of a run while it is simulated.
namespace hapbench {

/// Inputs of make_recorders() for one trial.
struct RecordedTrial {
  const RecordFields& fields;
  std::size_t contact_capacity;  ///< largest number of contacts in a step
  const SectionObservers& sections;
  const InsideObserver* inside;  ///< null if the environment has no solid
};

/// The tables of a trial in memory. Keys are the names of the corresponding files.
using RecordedTables = std::map<std::string, MemoryTable>;

/// Destination of a trial's tables: files in a directory, or tables in memory. The pointer is never null, and
/// the tables must outlive the recorders.
using RecordTarget = std::variant<std::filesystem::path, RecordedTables*>;

using Recorders = std::vector<std::unique_ptr<Recorder>>;

/// Creates the recorders that the scenario's record fields request. Throws IoError if a file cannot be created.
Recorders make_recorders(const RecordedTrial& trial, const RecordTarget& target);

/// Returns descriptions of the tables that a run with these record fields writes.
std::vector<ResultTable> tables_with(const RecordFields& fields);

/// Returns descriptions of all tables that a run can record.
std::vector<ResultTable> record_tables();

/// Number of contacts in each step that expected_output_bytes() assumes if contacts are recorded.
inline constexpr double kAssumedContacts = 30.0;

/// Returns an estimate of the bytes that a run of the scenario writes, all trials together. Assumes that the run makes
/// all its steps, and that each step has kAssumedContacts contacts. If this is right, the estimate is within a factor
/// of two. O(1).
double expected_output_bytes(const Scenario& scenario);

}  // namespace hapbench
