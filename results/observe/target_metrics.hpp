#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "results/io/columns.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Measurements of one target (thesis D.4). Model force and speed are means over the rows in which the tip was within
/// TargetRules::logged of the target, whether or not the subject pressed.
struct TargetRow {
  std::size_t subject = 0;  ///< from 0, as are trial and target
  std::size_t trial = 0;
  std::size_t target = 0;
  TargetResult result;
  std::uint64_t rows_on_target = 0;
  double model_force = 0.0;  ///< mean |f_render| [N]
  double speed = 0.0;        ///< mean speed of the handle [m/s]
};

/// Measures the targets of one trial while it runs.
class TargetMetricsObserver final : public Observer {
 public:
  /// Numbers of subject and trial, from 0, and the task at its beginning.
  TargetMetricsObserver(std::size_t subject, std::size_t trial, const TargetTask& task);

  /// Precondition: record.task is not null.
  void on_step(const StepRecord& record) noexcept override;

  /// The trial has come to nothing: the targets that have not ended are not removed, and take the time limit.
  void fail_rest();

  /// One row for each target that has ended.
  const std::vector<TargetRow>& rows() const noexcept { return rows_; }

 private:
  std::vector<std::size_t> order_;  ///< place of each target
  double time_limit_;
  TargetRow current_;  ///< sums where a finished row has means
  std::vector<TargetRow> rows_;
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

MetricList metric_list(const std::vector<PlaceMetrics>& places);

}  // namespace hapbench
