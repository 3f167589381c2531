#include "scenarios/analysis/stability/run_end_observer.hpp"

#include <algorithm>

#include "results/observe/metrics.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

bool contact_lasts(const SettledState& settled, const Scenario& scenario) {
  // A tool at rest keeps its contacts. The quarter in which it came to rest may include its landing.
  if (settled.rests) return settled.last_contact && settled.touches;
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  const bool is_moved = script_moves_until(scenario) > 0.75 * duration;
  return settled.last_contact && settled.share_away == 0.0 && !settled.directions_change &&
         (is_moved || !settled.contacts_change);
}

RunEndObserver::RunEndObserver(const Scenario& scenario, bool alone)
    : steps_(static_cast<std::uint64_t>(scenario.time.steps)),
      judged_(steps_, script_period(scenario) / scenario.time.step),
      vibration_(scenario.time.step),
      bounces_(scenario.time.step) {
  if (alone) judged_.touch(0);
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) coulomb_ = device->coulomb;
}

void RunEndObserver::on_step(const StepRecord& record) noexcept {
  touches_ = record.bears_contact();
  if (touches_) judged_.touch(record.step);
  if (touches_ && !touch_speed_) touch_speed_ = record.handle.velocity.norm();
  hand_force_max_ = std::max(hand_force_max_, record.hand_force.norm());
  vibration_.add(record.step, record.handle.velocity, judged_.contain(record.step));
  bounces_.add(record, judged_);
  tip_ = record.tool.pose.position;
  for (const double coordinate : record.handle.position) motion_.real(coordinate);
  if (const std::uint64_t quarter = record.step * 4 / steps_; quarter != quarter_) {
    quarter_ = quarter;
    steps_in_quarter_ = steps_in_contact_ = contacts_ = 0;
    S_sum_.setZero();
    last_set_.reset();
    contacts_change_ = directions_change_ = false;
  }
  ++steps_in_quarter_;
  sticks_ = record.force.friction == Friction::sticks;
  if (record.rendered->size() == 0) return;
  ++steps_in_contact_;
  contacts_ += record.rendered->size();
  S_sum_ += record.force.S;
  add_contact(record);
}

void RunEndObserver::add_contact(const StepRecord& record) noexcept {
  constexpr double kTurned = 0.01;  // allowed change of S relative to its norm
  constexpr double kEqual = 1e-9;   // larger than the relative rounding error of S
  const Mat3& S = record.force.S;
  if (!last_set_) S_first_ = S;
  directions_change_ |= (S - S_first_).norm() > kTurned * S_first_.norm();
  // Hash the set of contacts. A sum does not depend on their order.
  std::uint64_t set = 0;
  for (std::size_t i = 0; i < record.rendered->size(); ++i) {
    Hash64 hash;
    hash.word(record.rendered->index[i]);
    set += hash.value();
  }
  // A law may render one of several points that act alike, such as the points below a flat tip. Rounding then decides
  // which point the law renders. Another such point is no change of the contacts.
  const auto acts_alike = [&](const ContactSet& last) {
    return last.rendered == record.rendered->size() && last.colliding == record.colliding &&
           (S - last.S).norm() <= kEqual * last.S.norm();
  };
  contacts_change_ |= last_set_ && last_set_->hash != set && !acts_alike(*last_set_);
  last_set_ = {set, record.rendered->size(), record.colliding, S};
  last_contact_ = contact_state(record);
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
  state.touch_speed = touch_speed_;
  state.hand_force_max = hand_force_max_;
  state.last_contact = last_contact_;
  state.rests = rests;
  state.touches = touches_;
  state.is_held = rests && (coulomb_ > 0.0 || sticks_);
  if (steps_in_contact_ == 0) return state;
  state.share_away = 1.0 - static_cast<double>(steps_in_contact_) / static_cast<double>(steps_in_quarter_);
  state.contacts_change = contacts_change_;
  state.directions_change = directions_change_;
  const auto steps = static_cast<double>(steps_in_contact_);
  state.contacts = static_cast<double>(contacts_) / steps;
  state.lambda_max = lambda_max(S_sum_ / steps);
  return state;
}

}  // namespace hapbench
