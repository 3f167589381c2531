#pragma once

#include <cstdint>
#include <vector>

#include "results/observe/metric_observer.hpp"

namespace hapbench {

/// Measurements of one target (thesis D.4). Model force and speed are means over the rows in which the tip was within
/// TargetRules::logged of the target, whether or not the subject pressed.
struct TargetRow {
  std::size_t subject = 0;  ///< from 0, as are trial and target
  std::size_t trial = 0;
  std::size_t target = 0;
  TargetResult result = {};
  std::uint64_t rows_on_target = 0;
  double model_force = 0.0;  ///< mean |f_render| [N]
  double speed = 0.0;        ///< mean speed of the handle [m/s]
};

/// Measures the targets of all trials of a run.
class TargetMetricsObserver final : public MetricObserver {
 public:
  /// `places`: of the task, to name the metrics of an observer that sees no trial.
  explicit TargetMetricsObserver(std::size_t places = 2) : places_(places) {}

  /// Precondition: the trial's hand has a task.
  void begin(const TrialParts& trial) override;
  /// Precondition: record.task is not null.
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

  /// The trial begun last has come to nothing: targets that have not ended are not removed and take the time limit.
  void fail_rest();

  /// One row for each target that has ended, trial by trial.
  const std::vector<TargetRow>& rows() const noexcept { return rows_; }

 private:
  /// Targets of this trial that have ended.
  std::size_t ended() const noexcept { return rows_.size() - rows_before_; }

  std::size_t places_;
  std::vector<std::size_t> order_;  ///< place of each target; empty before the first trial
  double time_limit_ = 0.0;
  TargetRow current_;  ///< sums where a finished row has means
  std::vector<TargetRow> rows_;
  std::size_t rows_before_ = 0;  ///< of earlier trials
};

/// A mean over subjects and its standard error; without meaning when `subjects` is 0.
struct SubjectMean {
  std::size_t subjects = 0;
  double mean = 0.0;
  double standard_error = 0.0;  ///< 0 for one subject
};

/// One target place over all subjects. Each subject counts with the mean over its targets there, as in Table A.1; force
/// and speed leave out targets that the tip never was on.
struct PlaceMetrics {
  std::size_t place = 0;
  SubjectMean success_rate;
  SubjectMean completion_time;  ///< [s]; a target that disappeared counts with the time limit
  SubjectMean model_force;      ///< [N]
  SubjectMean speed;            ///< [m/s]
};

/// The tables of thesis D.4: one entry for each place that occurs.
std::vector<PlaceMetrics> place_metrics(const std::vector<TargetRow>& rows);

}  // namespace hapbench
