#include "device_model/hands/tracking_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
/// Range of the tilt from vertical [rad]. The wrist does not turn the tool beyond the vertical, and does not lay it
/// flat.
constexpr double kMinTilt = 0.0, kMaxTilt = 1.4;

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
  std::fill(seen_.begin(), seen_.end(), Display{});
  next_ = 0;
  started_ = false;
  random_ = Random(seed_);
  wrist_ = tilt_ = initial_tilt_;
  force_noise_.setZero();
  tilt_noise_ = 0.0;
}

Vec3 TrackingHand::force(double, const HandView& view) noexcept {
  // Update the task and respond to the delayed display.
  if (!started_) intended_ = view.handle.position;
  started_ = true;
  task_.advance(view.tool.position, view.spring_force.z(), view.model_force.z(), dt_);
  follow(delayed_display(view));
  // Limit the spring force by moving the intended position, and add motor noise. `reach` is the distance [m] between
  // intended position and handle at which the spring force in an axis is max_force.
  const Vec3 reach = Vec3::Constant(subject_.max_force / subject_.stiffness);
  intended_ = intended_.cwiseMax(view.handle.position - reach).cwiseMin(view.handle.position + reach);
  for (double& component : force_noise_) component = next_noise(component);
  return subject_.stiffness * (intended_ - view.handle.position) - subject_.damping * view.handle.velocity +
         subject_.motor_noise * force_noise_;
}

/// Stores the current display and returns the display of one reaction delay ago. Until one reaction delay has passed,
/// returns "on target, no force on the gauge".
TrackingHand::Display TrackingHand::delayed_display(const HandView& view) noexcept {
  Display& now = seen_[next_];
  now.error = task_.finished() ? Vec3(Vec3::Zero()) : task_.error(view.tool.position);
  now.gauge = task_.reading();
  next_ = (next_ + 1) % seen_.size();
  return seen_[next_];
}

/// Moves the intended position and the wrist in response to a display.
void TrackingHand::follow(const Display& seen) noexcept {
  const auto limited = [](double rate, double limit) { return std::clamp(rate, -limit, limit); };
  const double follow_rate = kTwoPi * subject_.bandwidth;
  // Follow the target: on the panel by moving the hand, on the height meter by rotating the wrist.
  if (task_.rules().display == TargetDisplay::panel) {
    intended_.x() += limited(follow_rate * seen.error.x(), subject_.max_speed) * dt_;
    intended_.y() += limited(follow_rate * seen.error.y(), subject_.max_speed) * dt_;
  } else {
    const double turn = limited(follow_rate * seen.error.z() / subject_.height_per_tilt, subject_.max_turn);
    wrist_ = std::clamp(wrist_ + turn * dt_, kMinTilt, kMaxTilt);
    tilt_noise_ = next_noise(tilt_noise_);
    tilt_ = wrist_ + subject_.tilt_noise * tilt_noise_;
  }
  // Correct the pressing force.
  const double press_rate = kTwoPi * subject_.press_bandwidth / subject_.stiffness;
  intended_.z() -= limited(press_rate * (subject_.press - seen.gauge), subject_.max_speed) * dt_;
}

/// Returns the next sample of first-order low-pass noise with unit variance and the subject's noise_bandwidth. `state`
/// is the previous sample.
double TrackingHand::next_noise(double state) noexcept {
  return noise_memory_ * state + std::sqrt(1.0 - noise_memory_ * noise_memory_) * random_.normal();
}

}  // namespace hapbench
