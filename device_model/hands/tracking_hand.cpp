#include "device_model/hands/tracking_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
/// Range of the tilt [rad]: the wrist neither lays the tool flat nor turns it past upright.
constexpr double kLeastTilt = 0.0, kMostTilt = 1.4;

TrackingHand::TrackingHand(const Subject& subject, TargetTask task, double initial_tilt, double dt, std::uint64_t seed)
    : subject_(subject),
      task_(std::move(task)),
      initial_tilt_(initial_tilt),
      dt_(dt),
      seed_(seed),
      noise_memory_(math::exp(-kTwoPi * subject.noise_bandwidth * dt)),
      seen_(1 + static_cast<std::size_t>(std::lround(subject.reaction_delay / dt))),
      random_(seed) {
  reset();
}

void TrackingHand::reset() noexcept {
  task_.reset();
  std::fill(seen_.begin(), seen_.end(), Seen{});
  next_ = 0;
  started_ = false;
  random_ = Random(seed_);
  wrist_ = tilt_ = initial_tilt_;
  force_noise_.setZero();
  tilt_noise_ = 0.0;
}

Vec3 TrackingHand::force(double, const HandView& view) noexcept {
  if (!started_) intended_ = view.handle.position;
  started_ = true;
  task_.advance(view.tool.position, view.spring_force.z(), view.model_force.z(), dt_);
  follow(look(view));
  const Vec3 reach = Vec3::Constant(subject_.max_force / subject_.stiffness);  // beyond it the arm yields
  intended_ = intended_.cwiseMax(view.handle.position - reach).cwiseMin(view.handle.position + reach);
  for (double& component : force_noise_) component = coloured(component);
  return subject_.stiffness * (intended_ - view.handle.position) - subject_.damping * view.handle.velocity +
         subject_.motor_noise * force_noise_;
}

/// Stores the present display and returns the one that the subject sees now, a reaction delay late. Before the first
/// one arrives that is "on target, nothing pressed".
TrackingHand::Seen TrackingHand::look(const HandView& view) noexcept {
  Seen& now = seen_[next_];
  now.error = task_.finished() ? Vec3(Vec3::Zero()) : task_.error(view.tool.position);
  now.gauge = task_.reading();
  next_ = (next_ + 1) % seen_.size();
  return seen_[next_];
}

void TrackingHand::follow(const Seen& seen) noexcept {
  const auto within = [](double rate, double most) { return std::clamp(rate, -most, most); };
  const double follow_rate = kTwoPi * subject_.bandwidth;
  if (task_.rules().display == TargetDisplay::panel) {
    intended_.x() += within(follow_rate * seen.error.x(), subject_.max_speed) * dt_;
    intended_.y() += within(follow_rate * seen.error.y(), subject_.max_speed) * dt_;
  } else {
    const double turn = within(follow_rate * seen.error.z() / subject_.height_per_tilt, subject_.max_turn);
    wrist_ = std::clamp(wrist_ + turn * dt_, kLeastTilt, kMostTilt);
    tilt_noise_ = coloured(tilt_noise_);
    tilt_ = wrist_ + subject_.tilt_noise * tilt_noise_;
  }
  const double press_rate = kTwoPi * subject_.press_bandwidth / subject_.stiffness;
  intended_.z() -= within(press_rate * (subject_.press - seen.gauge), subject_.max_speed) * dt_;
}

/// The next sample of noise of unit variance with the hand's bandwidth.
double TrackingHand::coloured(double state) noexcept {
  return noise_memory_ * state + std::sqrt(1.0 - noise_memory_ * noise_memory_) * random_.normal();
}

}  // namespace hapbench
