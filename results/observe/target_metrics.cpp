#include "results/observe/target_metrics.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <string>

namespace hapbench {

void TargetMetricsObserver::begin(const TrialParts& trial) {
  const TargetTask& task = *trial.simulation.hand->task();
  order_ = task.order();
  time_limit_ = task.rules().time_limit;
  current_ = {.subject = trial.subject, .trial = trial.trial};
  rows_before_ = rows_.size();
  rows_.reserve(rows_before_ + order_.size());
}

void TargetMetricsObserver::fail_rest() {
  while (ended() < order_.size())
    rows_.push_back({current_.subject, current_.trial, ended(), {order_[ended()], false, time_limit_}});
}

void TargetMetricsObserver::on_step(const StepRecord& record) noexcept {
  const TargetTask& task = *record.task;
  // If a target has ended, convert its sums to means.
  if (task.results().size() > ended()) {
    TargetRow row = current_;
    row.target = ended();
    row.result = task.results().back();
    if (row.rows_on_target > 0) {
      row.model_force = per(row.model_force, row.rows_on_target);
      row.speed = per(row.speed, row.rows_on_target);
    }
    rows_.push_back(row);
    current_ = {.subject = row.subject, .trial = row.trial};
  }
  // If the tip is on the current target, add force and speed of the step to the sums of this target.
  if (task.finished() || !task.logs(record.tool.pose.position)) return;
  ++current_.rows_on_target;
  current_.model_force += record.force.rendered.norm();
  current_.speed += record.handle.velocity.norm();
}

namespace {

/// Values of one quantity at one target position, by subject.
using ValuesOfSubjects = std::map<std::size_t, std::vector<double>>;

double mean_of(const std::vector<double>& values) {
  return per(std::accumulate(values.begin(), values.end(), 0.0), values.size());
}

SubjectMean over_subjects(const ValuesOfSubjects& subjects) {
  std::vector<double> means;
  for (const auto& [subject, values] : subjects) means.push_back(mean_of(values));
  if (means.empty()) return {};
  SubjectMean result{means.size(), mean_of(means)};
  if (means.size() < 2) return result;
  const auto n = static_cast<double>(means.size());
  double squares = 0.0;
  for (const double mean : means) squares += (mean - result.mean) * (mean - result.mean);
  result.standard_error = std::sqrt(squares / (n - 1.0) / n);
  return result;
}

void report_mean(Section s, const SubjectMean& m, const char* unit, const char* meaning, Better better = Better::none) {
  const bool any = m.subjects > 0;
  s.metric("mean", unit, meaning, if_any(any, m.mean), better);
  s.metric("standard_error", unit, "standard error of the mean, from the differences between the subjects' means",
           if_any(any, m.standard_error));
  s.metric("subjects", "1", "number of simulated subjects that have a value at this target position", m.subjects);
}

}  // namespace

std::vector<PositionMetrics> position_metrics(const std::vector<TargetRow>& rows) {
  struct Values {
    ValuesOfSubjects success, time, force, speed;
  };
  // Collect the values of each target position by subject.
  std::map<std::size_t, Values> positions;
  for (const TargetRow& row : rows) {
    Values& at = positions[row.result.position];
    at.success[row.subject].push_back(row.result.removed ? 1.0 : 0.0);
    at.time[row.subject].push_back(row.result.time);
    if (row.rows_on_target == 0) continue;
    at.force[row.subject].push_back(row.model_force);
    at.speed[row.subject].push_back(row.speed);
  }
  // Average over the subjects.
  std::vector<PositionMetrics> metrics;
  metrics.reserve(positions.size());
  for (const auto& [position, at] : positions) {
    metrics.push_back({position, over_subjects(at.success), over_subjects(at.time), over_subjects(at.force),
                       over_subjects(at.speed)});
  }
  return metrics;
}

void TargetMetricsObserver::report(Section& s) const {
  std::vector<PositionMetrics> positions = position_metrics(rows_);
  if (order_.empty()) {
    positions.resize(positions_);
    for (std::size_t i = 0; i < positions_; ++i) positions[i].position = i;
  }
  for (const PositionMetrics& position : positions) {
    const Section at = s.part(std::to_string(position.position));
    report_mean(at.part("success_rate"), position.success_rate, "1",
                "fraction of the targets at this position that the subject removed before the time limit (removed of "
                "targets.csv, rows of its place), mean over the subjects",
                Better::more);
    report_mean(
        at.part("completion_time_s"), position.completion_time, "s",
        "time until a target at this position was removed, or the time limit if it was not (time_s of targets.csv, "
        "rows of its place); mean over the subjects",
        Better::less);
    report_mean(
        at.part("model_force_N"), position.model_force, "N",
        "mean ||f|| over the steps with the tip on a target at this position (model_force_N of targets.csv), mean over "
        "the subjects' means");
    report_mean(at.part("speed_m_per_s"), position.speed, "m/s",
                "mean speed of the handle over the steps with the tip on a target at this position (speed_m_per_s of "
                "targets.csv), "
                "mean over the subjects' means");
  }
}

}  // namespace hapbench
