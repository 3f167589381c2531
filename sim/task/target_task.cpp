#include "sim/task/target_task.hpp"

#include <numbers>
#include <utility>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Updates the output of a first-order low-pass over the time dt [s], during which the input is constant. If there is
/// no cut-off frequency, output = input.
void follow(double& output, double input, std::optional<double> cutoff, double dt) noexcept {
  output = cutoff ? output - math::expm1(-2.0 * std::numbers::pi * *cutoff * dt) * (input - output) : input;
}

}  // namespace

TargetTask::TargetTask(TargetRules rules, std::uint64_t seed) : rules_(std::move(rules)) {
  for (std::size_t position = 0; position < rules_.positions.size(); ++position) {
    order_.insert(order_.end(), rules_.targets_per_position, position);
  }
  Random(seed).shuffle(order_);
  results_.reserve(order_.size());
}

void TargetTask::reset() noexcept {
  results_.clear();
  active_ = false;
  shown_ = held_ = 0.0;
  reading_ = checked_ = low_for_ = 0.0;
}

Vec3 TargetTask::error(const Vec3& tip) const noexcept {
  const Vec3 error = rules_.positions[position_index()] - tip;
  return rules_.display == TargetDisplay::panel ? Vec3(error.x(), error.y(), 0.0) : Vec3(0.0, 0.0, error.z());
}

void TargetTask::advance(const Vec3& tip, double spring, double rendered, double dt) noexcept {
  // Update the gauge that the subject sees and the force that the task checks.
  if (rules_.gauge) {
    follow(reading_, spring, rules_.gauge->cutoff, dt);
  } else {
    reading_ = rendered;
  }
  if (const auto& threshold = rules_.threshold) {
    follow(checked_, threshold->force == PressForce::rendered ? rendered : spring, threshold->cutoff, dt);
  } else {
    checked_ = reading_;
  }
  // Activate the target at the first press.
  if (finished()) return;
  const bool pressed = is_pressed(dt);
  if (pressed && !active_) {
    active_ = true;
    shown_ = 0.0;
  }
  shown_ += dt;
  // Update the time on the target.
  const LowForce low = active_ && !pressed && rules_.threshold ? rules_.threshold->low : LowForce::restarts;
  if (!(error(tip).norm() <= rules_.tolerance) || (!pressed && low == LowForce::restarts)) {
    held_ = 0.0;
  } else if (pressed || low == LowForce::nothing) {
    held_ += dt;
  }
  // Remove the target after the holding time, or let it disappear at the time limit.
  if (held_ >= rules_.hold) {
    next_target(true, shown_);
  } else if (shown_ >= rules_.time_limit || (!pressed && low == LowForce::closes)) {
    next_target(false, rules_.time_limit);
  }
}

/// Returns true if the checked force is at least min_press_force, or if the target is active and the force has been
/// lower for no longer than the grace time.
bool TargetTask::is_pressed(double dt) noexcept {
  if (checked_ >= rules_.min_press_force) {
    low_for_ = 0.0;
    return true;
  }
  low_for_ += dt;
  const double grace = rules_.threshold ? rules_.threshold->grace : rules_.gauge ? rules_.gauge->grace : 0.0;
  return active_ && low_for_ <= grace;
}

void TargetTask::next_target(bool removed, double time) noexcept {
  results_.push_back({position_index(), removed, time});
  active_ = false;
  shown_ = held_ = 0.0;
}

}  // namespace hapbench
