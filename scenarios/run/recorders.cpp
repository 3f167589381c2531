#include "scenarios/run/recorders.hpp"

#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/record/contact_recorder.hpp"
#include "results/record/energy_recorder.hpp"
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

Made trajectory(const RecordedTrial& t, const fs::path& file) {
  return t.fields.trajectory ? std::make_unique<TrajectoryRecorder>(file, every(t)) : nullptr;
}

Made contacts(const RecordedTrial& t, const fs::path& file) {
  return t.fields.contacts ? std::make_unique<ContactRecorder>(file, every(t)) : nullptr;
}

Made stiffness_tensor(const RecordedTrial& t, const fs::path& file) {
  return t.fields.stiffness_tensor ? std::make_unique<StiffnessRecorder>(file, every(t)) : nullptr;
}

Mat3 start_shaping(ContactBuffer& contacts) noexcept {
  return shape_weights(contacts, 0);
}

Made ratios(const RecordedTrial& t, const fs::path& file) {
  const auto& asked = t.fields.ratio_iterations;
  if (asked.empty()) return nullptr;
  const std::vector<int> iterations(asked.begin(), asked.end());
  const ShapingOperations shaping{start_shaping, update_shaped_weights};
  return std::make_unique<RatioRecorder>(file, every(t), iterations, shaping, t.contact_capacity);
}

Made energy(const RecordedTrial& t, const fs::path& file) {
  return t.ledger != nullptr ? std::make_unique<EnergyRecorder>(file, every(t), *t.ledger) : nullptr;
}

Made ideal_trajectory(const RecordedTrial& t, const fs::path& file) {
  return t.ideal != nullptr ? std::make_unique<IdealTrajectoryRecorder>(file, every(t), *t.ideal) : nullptr;
}

struct RecorderEntry {
  const char* file;
  Made (*make)(const RecordedTrial&, const fs::path& file);  ///< null unless the scenario asks for it
};

constexpr RecorderEntry kRecorders[] = {
    {"trajectory.csv", trajectory}, {"contacts.csv", contacts}, {"stiffness_tensor.csv", stiffness_tensor},
    {"ratios.csv", ratios},         {"energy.csv", energy},     {"ideal_trajectory.csv", ideal_trajectory}};

}  // namespace

std::vector<std::unique_ptr<Recorder>> make_recorders(const RecordedTrial& trial, const fs::path& directory) {
  std::vector<std::unique_ptr<Recorder>> recorders;
  for (const RecorderEntry& entry : kRecorders) {
    if (Made recorder = entry.make(trial, directory / entry.file)) recorders.push_back(std::move(recorder));
  }
  return recorders;
}

std::vector<std::string> record_files() {
  std::vector<std::string> files;
  for (const RecorderEntry& entry : kRecorders) files.emplace_back(entry.file);
  return files;
}

}  // namespace hapbench
