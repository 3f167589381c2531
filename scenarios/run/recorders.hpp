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

/// What a run records, row by row.
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

/// The tables that a run with these fields writes.
std::vector<ResultTable> tables_with(const RecordFields& fields);

/// The tables of all recorders there are.
std::vector<ResultTable> record_tables();

/// About how many bytes a run of the scenario will write, all trials together: 12 for each number, if every step is
/// done and has 30 contacts. Within a factor of two, but for those. O(1).
double expected_output_bytes(const Scenario& scenario);

}  // namespace hapbench
