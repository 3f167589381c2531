#include "results/record/ideal_trajectory_recorder.hpp"

#include <utility>

namespace hapbench {

IdealTrajectoryRecorder::IdealTrajectoryRecorder(TableTarget target, const IdealTrajectoryObserver& observer)
    : writer_(std::move(target), kColumns), observer_(&observer) {}

void IdealTrajectoryRecorder::on_step(const StepRecord& record) noexcept {
  if (!observer_->error()) return;
  const TrajectoryError& e = *observer_->error();
  writer_.row(record.step, record.time, e.tilt, e.actual.height, e.ideal.height, e.actual.lateral, e.ideal.lateral,
              e.interpenetration, e.hand_force);
}

}  // namespace hapbench
