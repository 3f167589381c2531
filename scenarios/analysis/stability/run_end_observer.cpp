#include "scenarios/analysis/stability/run_end_observer.hpp"

#include "results/observe/metrics.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

RunEndObserver::RunEndObserver(const Scenario& scenario, bool alone)
    : steps_(static_cast<std::uint64_t>(scenario.time.steps)),
      judged_(steps_, script_period(scenario) / scenario.time.step),
      vibration_(scenario.time.step),
      bounces_(scenario.time.step) {
  if (alone) judged_.touch(0);
}

void RunEndObserver::on_step(const StepRecord& record) noexcept {
  touches_ = record.colliding > 0;
  if (touches_) judged_.touch(record.step);
  vibration_.add(record.step, record.handle.velocity, judged_.contain(record.step));
  bounces_.add(record, judged_);
  tip_ = record.tool.pose.position;
  for (const double coordinate : record.handle.position) motion_.real(coordinate);
  if (const std::uint64_t quarter = record.step * 4 / steps_; quarter != quarter_) {
    quarter_ = quarter;
    steps_in_contact_ = contacts_ = 0;
    S_sum_.setZero();
  }
  if (record.rendered->size() == 0) return;
  ++steps_in_contact_;
  contacts_ += record.rendered->size();
  S_sum_ += record.force.S;
}

bool RunEndObserver::has_left(const PointShell& shell, double reach) const {
  const Box& bounds = shell.bounds();
  const Vec3 beyond = (bounds.min - tip_).cwiseMax(tip_ - bounds.max);
  return !touches_ && beyond.maxCoeff() > reach;
}

SettledState RunEndObserver::state(bool rests) const {
  SettledState state;
  // If the run was stopped because the tool came to rest, the steps that were not simulated count with velocity 0.
  state.vibration = vibration_.rms(if_any(rests && judged_.begin(), judged_.end() - judged_.begin().value_or(0)));
  if (steps_in_contact_ == 0) return state;
  const auto steps = static_cast<double>(steps_in_contact_);
  state.contacts = static_cast<double>(contacts_) / steps;
  state.lambda_max = lambda_max(S_sum_ / steps);
  return state;
}

}  // namespace hapbench
