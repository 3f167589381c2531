#pragma once

#include <cstdint>
#include <vector>

#include "results/observe/metric_observer.hpp"

namespace hapbench {

/// Measurements of one target (thesis D.4). `model_force` and `speed` are means over the steps with the tip on the
/// target, that is, within TargetRules::logged (if empty: TargetRules::tolerance) of the target. Steps in which the
/// force is smaller than TargetRules::min_press_force are included.
struct TargetRow {
  std::size_t subject = 0;  ///< number of the subject; the numbers of subject, trial and target start at 0
  std::size_t trial = 0;
  std::size_t target = 0;
  TargetResult result = {};
  std::uint64_t rows_on_target = 0;  ///< number of steps with the tip on the target
  double model_force = 0.0;          ///< mean ||f_render|| [N]
  double speed = 0.0;                ///< mean speed of the handle [m/s]
};

/// Measures the targets of all trials of a run.
class TargetMetricsObserver final : public MetricObserver {
 public:
  /// `positions`: number of target positions of the task; used only if no trial has begun, to list the names of the
  /// metrics.
  explicit TargetMetricsObserver(std::size_t positions = 2) : positions_(positions) {}

  /// Precondition: the trial's hand has a task.
  void begin(const TrialParts& trial) override;
  /// Precondition: record.task is not null.
  void on_step(const StepRecord& record) noexcept override;
  void report(Section& section) const override;

  /// Marks the current trial as failed: its targets that have not ended count as not removed, and their time is the
  /// time limit.
  void fail_rest();

  /// Measurements of each target that has ended, trial by trial.
  const std::vector<TargetRow>& rows() const noexcept { return rows_; }

 private:
  /// Returns the number of targets of this trial that have ended.
  std::size_t ended() const noexcept { return rows_.size() - rows_before_; }

  std::size_t positions_;
  std::vector<std::size_t> order_;  ///< position number of each target; empty before the first trial
  double time_limit_ = 0.0;         ///< [s]
  TargetRow current_;  ///< sums over the steps on the current target, which become means when the target ends
  std::vector<TargetRow> rows_;
  std::size_t rows_before_ = 0;  ///< number of targets of earlier trials
};

/// Mean over subjects and its standard error; undefined if `subjects` is 0.
struct SubjectMean {
  std::size_t subjects = 0;
  double mean = 0.0;
  double standard_error = 0.0;  ///< 0 for one subject
};

/// Measurements at one target position over all subjects. Each subject contributes the mean over its targets at this
/// position, as in Table A.1 of the thesis. Force and speed exclude targets that the tip never reached.
struct PositionMetrics {
  std::size_t position = 0;
  SubjectMean success_rate;
  SubjectMean completion_time;  ///< [s]; for a target that was not removed, the time limit
  SubjectMean model_force;      ///< [N]
  SubjectMean speed;            ///< [m/s]
};

/// Returns the tables of thesis D.4: one entry for each target position in `rows`.
std::vector<PositionMetrics> position_metrics(const std::vector<TargetRow>& rows);

}  // namespace hapbench
