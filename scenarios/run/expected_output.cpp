#include "scenarios/run/expected_output.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "results/record/contact_recorder.hpp"
#include "results/record/energy_recorder.hpp"
#include "results/record/ideal_trajectory_recorder.hpp"
#include "results/record/ratio_recorder.hpp"
#include "results/record/stiffness_recorder.hpp"
#include "results/record/trajectory_recorder.hpp"

namespace hapbench {
namespace {

constexpr double kBytesOfANumber = 12.0;  // between a zero and seventeen digits
constexpr double kContactsOfARow = 30.0;

double line_bytes(std::string_view header) {
  return kBytesOfANumber * static_cast<double>(1 + std::count(header.begin(), header.end(), ','));
}

double trials_of(const Scenario& scenario) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  return hand == nullptr ? 1.0 : static_cast<double>(hand->subjects.size()) * static_cast<double>(hand->trials);
}

}  // namespace

double expected_output_bytes(const Scenario& scenario) {
  const RecordFields& record = scenario.record;
  double row = 0.0;
  if (record.trajectory) row += line_bytes(TrajectoryRecorder::kHeader);
  if (record.contacts) row += kContactsOfARow * line_bytes(ContactRecorder::kHeader);
  if (record.stiffness_tensor) row += line_bytes(StiffnessRecorder::kHeader);
  row += static_cast<double>(record.ratio_iterations.size()) * line_bytes(RatioRecorder::kHeader);
  if (record.energy) row += line_bytes(EnergyRecorder::kHeader);
  if (record.ideal_trajectory) row += line_bytes(IdealTrajectoryRecorder::kHeader);
  const double rows = std::ceil(static_cast<double>(scenario.time.steps) / static_cast<double>(record.every));
  return trials_of(scenario) * rows * row;
}

}  // namespace hapbench
