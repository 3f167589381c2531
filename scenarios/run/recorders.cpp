#include "scenarios/run/recorders.hpp"

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
Made plain(const RecordedTrial& t, const fs::path& file) {
  return std::make_unique<Plain>(file, every(t));
}

Mat3 start_shaping(ContactBuffer& contacts) noexcept {
  return shape_weights(contacts, 0);
}

Made ratios(const RecordedTrial& t, const fs::path& file) {
  const auto& asked = t.fields.ratio_iterations;
  const std::vector<int> iterations(asked.begin(), asked.end());
  const ShapingOperations shaping{start_shaping, update_shaped_weights};
  return std::make_unique<RatioRecorder>(file, every(t), iterations, shaping, t.contact_capacity);
}

Made energy(const RecordedTrial& t, const fs::path& file) {
  return std::make_unique<EnergyRecorder>(file, every(t), *t.ledger);
}

Made ideal_trajectory(const RecordedTrial& t, const fs::path& file) {
  return std::make_unique<IdealTrajectoryRecorder>(file, *t.ideal);
}

/// check_named_files has seen to it that there is a measured force.
Made force_reference(const RecordedTrial& t, const fs::path& file) {
  return std::make_unique<ForceReferenceRecorder>(file, every(t), *t.fidelity);
}

struct RecorderEntry {
  ResultTable table;
  bool (*is_wanted)(const RecordFields& fields);
  Made (*make)(const RecordedTrial&, const fs::path& file);
};

constexpr RecorderEntry kRecorders[] = {
    {{"trajectory.csv", "one line per recorded row, before the tool moves on", TrajectoryRecorder::kColumns},
     [](const RecordFields& f) { return f.trajectory; },
     plain<TrajectoryRecorder>},
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

}  // namespace

std::vector<std::unique_ptr<Recorder>> make_recorders(const RecordedTrial& trial, const fs::path& directory) {
  std::vector<std::unique_ptr<Recorder>> recorders;
  for (const RecorderEntry& entry : kRecorders) {
    if (entry.is_wanted(trial.fields)) recorders.push_back(entry.make(trial, directory / entry.table.file));
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
    if (entry.is_wanted(fields)) tables.push_back(entry.table);
  }
  return tables;
}

}  // namespace hapbench
