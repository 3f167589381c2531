#include "results/record/ideal_trajectory_recorder.hpp"

#include <cassert>
#include <utility>

namespace hapbench {

IdealTrajectoryRecorder::IdealTrajectoryRecorder(std::filesystem::path file, std::uint64_t every,
                                                 const IdealTrajectoryObserver& observer)
    : csv_(std::move(file), kColumns), every_(every), observer_(&observer) {
  assert(every > 0);
}

void IdealTrajectoryRecorder::on_step(const StepRecord& record) noexcept {
  if (!is_recorded(record, every_) || !observer_->error()) return;
  const TrajectoryError& e = *observer_->error();
  csv_.row(record.step, record.time, e.tilt, e.actual.height, e.ideal.height, e.actual.lateral, e.ideal.lateral,
           e.interpenetration, e.hand_force);
}

}  // namespace hapbench
