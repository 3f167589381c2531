#include "scenarios/run/recorders.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/io/columns.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/six_dof_observer.hpp"

namespace hapbench {
namespace {

/// Returns the source of ratios.csv: the stiffness ratios after each requested number of shaping iterations.
RowSource ratios(const RecordedTrial& t) {
  const auto& iterations = t.fields.ratio_iterations;
  constexpr auto start = [](ContactBuffer& contacts) noexcept { return shape_weights(contacts, 0); };
  return ratio_rows({iterations.begin(), iterations.end()}, {start, update_shaped_weights}, t.contact_capacity);
}

/// A table, the condition under which a scenario records it, and the source of its lines.
struct RecorderEntry {
  const ResultTable& table;
  std::function<bool(const RecordFields&)> is_wanted;
  RowSource (*rows)(const RecordedTrial& trial);
  /// True if the source itself selects the steps that it writes, so that record.every does not apply.
  bool has_every_row = false;
};

// SectionObservers::find() never returns null here, because the record field that requests a table also creates the
// table's observer. checked() has rejected record.force_reference for a scenario that has neither a reference force nor
// a measured force.
const RecorderEntry kRecorders[] = {
    {kTrajectoryTable, &RecordFields::trajectory,
     [](const RecordedTrial& t) { return trajectory_rows(t.fields, t.inside); }},
    {kContactTable, &RecordFields::contacts, [](const RecordedTrial&) { return contact_rows(); }},
    {kContactTraceTable, &RecordFields::contacts, [](const RecordedTrial&) { return contact_trace_rows(); }},
    {kStiffnessTable, &RecordFields::stiffness_tensor, [](const RecordedTrial&) { return stiffness_rows(); }},
    {kRatioTable, [](const RecordFields& f) { return !f.ratio_iterations.empty(); }, ratios},
    {kEnergyTable, &RecordFields::energy,
     [](const RecordedTrial& t) { return energy_rows(*t.sections.find<EnergyLedger>()); }},
    {kIdealTrajectoryTable, &RecordFields::ideal_trajectory,
     [](const RecordedTrial& t) { return ideal_trajectory_rows(*t.sections.find<IdealTrajectoryObserver>()); }, true},
    {kForceReferenceTable, &RecordFields::force_reference,
     [](const RecordedTrial& t) { return force_reference_rows(*t.sections.find<ForceFidelityObserver>()); }},
    {kSixDofTable, &RecordFields::six_dof,
     [](const RecordedTrial& t) { return six_dof_rows(t.sections.find<SixDofObserver>()->row()); }}};

constexpr double kBytesPerNumber = 19.0;  // an estimate: most numbers have seventeen digits
constexpr double kOtherBytes = 20e3;      // an estimate of summary.json and scenario.effective.json

/// Returns the estimated number of lines that a table gets for each recorded step.
double lines_per_row(const ResultTable& table, const RecordFields& record) {
  const std::string_view file = table.file;
  if (file == "contacts.csv" || file == "contact_trace.csv") return kAssumedContacts;
  return file == "ratios.csv" ? static_cast<double>(record.ratio_iterations.size()) : 1.0;
}

}  // namespace

std::vector<ResultTable> tables_with(const RecordFields& fields) {
  std::vector<ResultTable> tables;
  for (const RecorderEntry& entry : kRecorders) {
    if (!entry.is_wanted(fields)) continue;
    tables.push_back(entry.table);
    if (&entry.table == &kTrajectoryTable) tables.back().columns = trajectory_rows(fields).columns;
  }
  return tables;
}

Recorders make_recorders(const RecordedTrial& trial, const RecordTarget& target) {
  Recorders recorders;
  for (const RecorderEntry& entry : kRecorders) {
    if (!entry.is_wanted(trial.fields)) continue;
    RowSource rows = entry.rows(trial);
    // Record into a file or into a table in memory.
    const auto destination = [&]() -> TableTarget {
      if (const auto* directory = std::get_if<std::filesystem::path>(&target)) return *directory / entry.table.file;
      return &std::get<RecordedTables*>(target)->try_emplace(entry.table.file, rows.columns).first->second;
    }();
    const auto every = static_cast<std::uint64_t>(entry.has_every_row ? 1 : trial.fields.every);
    recorders.push_back(std::make_unique<Recorder>(destination, std::move(rows), every));
  }
  return recorders;
}

std::vector<ResultTable> record_tables() {
  std::vector<ResultTable> tables;
  for (const RecorderEntry& entry : kRecorders) tables.push_back(entry.table);
  return tables;
}

double expected_output_bytes(const Scenario& scenario) {
  const RecordFields& record = scenario.record;
  double row = 0.0;
  for (const ResultTable& table : tables_with(record))
    row += lines_per_row(table, record) * kBytesPerNumber * static_cast<double>(table.columns.size());
  const double rows = std::ceil(static_cast<double>(scenario.time.steps) / static_cast<double>(record.every));
  return trial_count(scenario.hand) * rows * row + kOtherBytes;
}

}  // namespace hapbench
