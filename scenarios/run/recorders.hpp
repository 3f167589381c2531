#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "results/io/columns.hpp"
#include "results/io/table_writer.hpp"
#include "results/observe/inside.hpp"
#include "results/record/recorder.hpp"
#include "scenarios/description/metric_sections.hpp"

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
/// The tables that a run with these fields writes.
std::vector<ResultTable> record_tables(const RecordFields& fields);

/// About how many bytes a run of the scenario will write [bytes]: rows times columns times 12 of what it records, all
/// trials together. An upper estimate of the rows: every step is done, and for contacts.csv 30 contacts are in each of
/// them. Sizes known beforehand are within a factor of two; that of contacts.csv is a guess. O(1).
double expected_output_bytes(const Scenario& scenario);

}  // namespace hapbench
