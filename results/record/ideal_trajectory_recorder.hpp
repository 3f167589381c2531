#pragma once

#include "results/io/table_writer.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// ideal_trajectory.csv: the compared rows at whose tilt the ideal trajectory exists, beside it (thesis Fig. 7).
/// Lateral distances count towards where the tool leans, heights from the hole's mouth.
class IdealTrajectoryRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"tilt_rad", "rad", "angle of the tool's axis to the hole's"},
      {"height_m", "m", "tip's centre above the hole's mouth; negative in the hole"},
      {"ideal_height_m", "m", "the same of the ideal trajectory"},
      {"lateral_m", "m", "tip's centre from the hole's axis, towards where the tool leans"},
      {"ideal_lateral_m", "m", "the same of the ideal trajectory"},
      {"interpenetration_m", "m", "true depth of the tool in the exact block"},
      {"hand_force_N", "N", "norm of the hand's force"}};

  /// Keeps the rows that `observer` compares; must observe after it. Throws IoError.
  IdealTrajectoryRecorder(TableTarget target, const IdealTrajectoryObserver& observer);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  const IdealTrajectoryObserver* observer_;
};

}  // namespace hapbench
