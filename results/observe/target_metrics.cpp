#include "results/observe/target_metrics.hpp"

#include <cmath>
#include <map>
#include <string>

#include "sim/loop/simulation.hpp"

namespace hapbench {

void TargetMetricsObserver::begin(const TrialParts& trial) {
  const TargetTask& task = *trial.simulation.hand->task();
  order_ = task.order();
  time_limit_ = task.rules().time_limit;
  current_ = {};
  current_.subject = trial.subject;
  current_.trial = trial.trial;
  rows_before_ = rows_.size();
  rows_.reserve(rows_before_ + order_.size());
}

void TargetMetricsObserver::fail_rest() {
  while (ended() < order_.size())
    rows_.push_back({current_.subject, current_.trial, ended(), {order_[ended()], false, time_limit_}});
}

void TargetMetricsObserver::on_step(const StepRecord& record) noexcept {
  const TargetTask& task = *record.task;
  if (task.results().size() > ended()) {
    TargetRow row = current_;
    row.target = ended();
    row.result = task.results().back();
    if (row.rows_on_target > 0) {
      row.model_force /= static_cast<double>(row.rows_on_target);
      row.speed /= static_cast<double>(row.rows_on_target);
    }
    rows_.push_back(row);
    current_.rows_on_target = 0;
    current_.model_force = current_.speed = 0.0;
  }
  if (task.finished() || !task.logs(record.tool.pose.position)) return;
  ++current_.rows_on_target;
  current_.model_force += record.force.rendered.norm();
  current_.speed += record.handle.velocity.norm();
}

namespace {

struct Mean {
  std::size_t count = 0;
  double sum = 0.0;
  void add(double value) {
    ++count;
    sum += value;
  }
};

/// Means of one subject at one place.
struct SubjectAtPlace {
  Mean success, time, force, speed;
};

SubjectMean over_subjects(const std::map<std::size_t, SubjectAtPlace>& subjects, Mean SubjectAtPlace::*quantity) {
  std::vector<double> means;
  for (const auto& [subject, values] : subjects) {
    const Mean& mean = values.*quantity;
    if (mean.count > 0) means.push_back(mean.sum / static_cast<double>(mean.count));
  }
  SubjectMean result;
  result.subjects = means.size();
  if (means.empty()) return result;
  const auto n = static_cast<double>(means.size());
  for (const double mean : means) result.mean += mean;
  result.mean /= n;
  if (means.size() < 2) return result;
  double squares = 0.0;
  for (const double mean : means) squares += (mean - result.mean) * (mean - result.mean);
  result.standard_error = std::sqrt(squares / (n - 1.0) / n);
  return result;
}

void tell_mean(Section s, const SubjectMean& m, const char* unit, const char* meaning, Better better = Better::none) {
  const bool any = m.subjects > 0;
  s.metric("mean", unit, meaning, if_any(any, m.mean), better);
  s.metric("standard_error", unit, "standard error of that mean, over subjects", if_any(any, m.standard_error));
  s.metric("subjects", "1", "subjects that have a value", m.subjects);
}

void tell_place(Section s, const PlaceMetrics& place) {
  tell_mean(s.part("success_rate"), place.success_rate, "1",
            "share of the targets at this place that were removed, mean over subjects", Better::more);
  tell_mean(s.part("completion_time_s"), place.completion_time, "s",
            "time until a target at this place was removed or the limit was reached, mean over subjects", Better::less);
  tell_mean(s.part("model_force_N"), place.model_force, "N",
            "mean ||f|| of the rows logged at a target of this place, mean over subjects");
  tell_mean(s.part("speed_m_per_s"), place.speed, "m/s",
            "mean speed of the handle in the rows logged at a target of this place, mean over subjects");
}

}  // namespace

std::vector<PlaceMetrics> place_metrics(const std::vector<TargetRow>& rows) {
  std::map<std::size_t, std::map<std::size_t, SubjectAtPlace>> places;
  for (const TargetRow& row : rows) {
    SubjectAtPlace& values = places[row.result.place][row.subject];
    values.success.add(row.result.removed ? 1.0 : 0.0);
    values.time.add(row.result.time);
    if (row.rows_on_target == 0) continue;
    values.force.add(row.model_force);
    values.speed.add(row.speed);
  }
  std::vector<PlaceMetrics> metrics;
  for (const auto& [place, subjects] : places) {
    metrics.push_back({place, over_subjects(subjects, &SubjectAtPlace::success),
                       over_subjects(subjects, &SubjectAtPlace::time), over_subjects(subjects, &SubjectAtPlace::force),
                       over_subjects(subjects, &SubjectAtPlace::speed)});
  }
  return metrics;
}

void TargetMetricsObserver::tell(Section& s) const {
  std::vector<PlaceMetrics> places = place_metrics(rows_);
  if (order_.empty()) {
    places.resize(places_);
    for (std::size_t i = 0; i < places_; ++i) places[i].place = i;
  }
  for (const PlaceMetrics& place : places) tell_place(s.part(std::to_string(place.place)), place);
}

}  // namespace hapbench
