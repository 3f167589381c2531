#include "results/record/ideal_trajectory_recorder.hpp"

#include <utility>

namespace hapbench {

IdealTrajectoryRecorder::IdealTrajectoryRecorder(std::filesystem::path file, const IdealTrajectoryObserver& observer)
    : csv_(std::move(file), kColumns), observer_(&observer) {}

void IdealTrajectoryRecorder::on_step(const StepRecord& record) noexcept {
  if (!observer_->error()) return;
  const TrajectoryError& e = *observer_->error();
  csv_.row(record.step, record.time, e.tilt, e.actual.height, e.ideal.height, e.actual.lateral, e.ideal.lateral,
           e.interpenetration, e.hand_force);
}

}  // namespace hapbench
