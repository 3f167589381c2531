#include "scenarios/run/recorders.hpp"

#include <cmath>
#include <string_view>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/record/contact_recorder.hpp"
#include "results/record/energy_recorder.hpp"
#include "results/record/force_reference_recorder.hpp"
#include "results/record/ideal_trajectory_recorder.hpp"
#include "results/record/ratio_recorder.hpp"
#include "results/record/stiffness_recorder.hpp"
#include "results/record/trajectory_recorder.hpp"

namespace hapbench {

namespace {

namespace fs = std::filesystem;
using Made = std::unique_ptr<Recorder>;

std::uint64_t every(const RecordedTrial& trial) {
  return static_cast<std::uint64_t>(trial.fields.every);
}

template <class Plain>
Made plain(const RecordedTrial& t, TableTarget to) {
  return std::make_unique<Plain>(std::move(to), every(t));
}

TrajectoryExtras extras(const RecordFields& fields) {
  return {fields.pose, fields.torque};
}

Made trajectory(const RecordedTrial& t, TableTarget to) {
  return std::make_unique<TrajectoryRecorder>(std::move(to), every(t), extras(t.fields));
}

Mat3 start_shaping(ContactBuffer& contacts) noexcept {
  return shape_weights(contacts, 0);
}

Made ratios(const RecordedTrial& t, TableTarget to) {
  const auto& asked = t.fields.ratio_iterations;
  const std::vector<int> iterations(asked.begin(), asked.end());
  const ShapingOperations shaping{start_shaping, update_shaped_weights};
  return std::make_unique<RatioRecorder>(std::move(to), every(t), iterations, shaping, t.contact_capacity);
}

Made energy(const RecordedTrial& t, TableTarget to) {
  return std::make_unique<EnergyRecorder>(std::move(to), every(t), *t.ledger);
}

Made ideal_trajectory(const RecordedTrial& t, TableTarget to) {
  return std::make_unique<IdealTrajectoryRecorder>(std::move(to), *t.ideal);
}

/// check_named_files has seen to it that there is a measured force.
Made force_reference(const RecordedTrial& t, TableTarget to) {
  return std::make_unique<ForceReferenceRecorder>(std::move(to), every(t), *t.fidelity);
}

struct RecorderEntry {
  ResultTable table;
  bool (*is_wanted)(const RecordFields& fields);
  Made (*make)(const RecordedTrial&, TableTarget to);
};

const RecorderEntry kRecorders[] = {
    {{"trajectory.csv",
      "one line per recorded row, before the tool moves on; qw to qz with record.pose, tx_Nm to tz_Nm with "
      "record.torque",
      TrajectoryRecorder::columns({true, true})},
     [](const RecordFields& f) { return f.trajectory; },
     trajectory},
    {{"contacts.csv", "with record.contacts: one line per rendered contact of each recorded row",
      ContactRecorder::kColumns},
     [](const RecordFields& f) { return f.contacts; },
     plain<ContactRecorder>},
    {{"stiffness_tensor.csv", "with record.stiffness_tensor: one line per recorded row", StiffnessRecorder::kColumns},
     [](const RecordFields& f) { return f.stiffness_tensor; },
     plain<StiffnessRecorder>},
    {{"ratios.csv", "with record.ratio_iterations: one line per iteration of each recorded row in contact",
      RatioRecorder::kColumns},
     [](const RecordFields& f) { return !f.ratio_iterations.empty(); },
     ratios},
    {{"energy.csv", "with record.energy: the energy balance, one line per recorded row", EnergyRecorder::kColumns},
     [](const RecordFields& f) { return f.energy; },
     energy},
    {{"ideal_trajectory.csv",
      "with record.ideal_trajectory: one line per recorded row at whose tilt the ideal trajectory exists",
      IdealTrajectoryRecorder::kColumns},
     [](const RecordFields& f) { return f.ideal_trajectory; },
     ideal_trajectory},
    {{"force_reference.csv", "with record.force_reference: the measured force of a stroke, one line per recorded row",
      ForceReferenceRecorder::kColumns},
     [](const RecordFields& f) { return f.force_reference; },
     force_reference}};

std::span<const Column> columns_of(const RecorderEntry& entry, const RecordFields& fields) {
  return entry.make == trajectory ? TrajectoryRecorder::columns(extras(fields)) : entry.table.columns;
}

MemoryTable& table_in_memory(RecordedTables& tables, const RecorderEntry& entry, const RecordedTrial& trial) {
  return tables.try_emplace(entry.table.file, columns_of(entry, trial.fields)).first->second;
}

}  // namespace

std::vector<std::unique_ptr<Recorder>> make_recorders(const RecordedTrial& trial, const RecordTarget& target) {
  std::vector<std::unique_ptr<Recorder>> recorders;
  for (const RecorderEntry& entry : kRecorders) {
    if (!entry.is_wanted(trial.fields)) continue;
    const auto* directory = std::get_if<fs::path>(&target);
    recorders.push_back(entry.make(trial, directory
                                              ? TableTarget(*directory / entry.table.file)
                                              : &table_in_memory(*std::get<RecordedTables*>(target), entry, trial)));
  }
  return recorders;
}

std::vector<ResultTable> record_tables() {
  std::vector<ResultTable> tables;
  for (const RecorderEntry& entry : kRecorders) tables.push_back(entry.table);
  return tables;
}

std::vector<ResultTable> record_tables(const RecordFields& fields) {
  std::vector<ResultTable> tables;
  for (const RecorderEntry& entry : kRecorders) {
    if (entry.is_wanted(fields)) tables.push_back({entry.table.file, entry.table.holds, columns_of(entry, fields)});
  }
  return tables;
}

namespace {

constexpr double kBytesOfANumber = 12.0;  // between a zero and seventeen digits
constexpr double kContactsOfARow = 30.0;

double lines_a_row(const ResultTable& table, const RecordFields& record) {
  const std::string_view file = table.file;
  if (file == "contacts.csv") return kContactsOfARow;
  return file == "ratios.csv" ? static_cast<double>(record.ratio_iterations.size()) : 1.0;
}

}  // namespace

double expected_output_bytes(const Scenario& scenario) {
  const RecordFields& record = scenario.record;
  double row = 0.0;
  for (const ResultTable& table : record_tables(record))
    row += lines_a_row(table, record) * kBytesOfANumber * static_cast<double>(table.columns.size());
  const double rows = std::ceil(static_cast<double>(scenario.time.steps) / static_cast<double>(record.every));
  return trial_count(scenario.hand) * rows * row;
}

}  // namespace hapbench
