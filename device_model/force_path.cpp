#include "device_model/force_path.hpp"

#include <algorithm>
#include <cmath>

#include "device_model/resolution.hpp"

namespace hapbench {

// The ring holds the commands of this period, of the whole periods of the delay and of the one that a fraction of it
// still lets through.
ForcePath::ForcePath(const ForcePathConfig& config, double dt)
    : config_(config),
      largest_change_(config.slew.value_or(0.0) * dt),
      switch_part_(config.delay_samples - std::floor(config.delay_samples)),
      commands_(static_cast<std::size_t>(config.delay_samples) + 2, Vec3::Zero()) {}

void ForcePath::reset() noexcept {
  std::fill(commands_.begin(), commands_.end(), Vec3::Zero());
  next_ = 0;
  last_.setZero();
}

HeldForce ForcePath::hold(const Vec3& rendered) noexcept {
  last_ = commands_[next_] = command(rendered);
  next_ = (next_ + 1) % commands_.size();
  return {commands_[next_], commands_[(next_ + 1) % commands_.size()]};
}

Vec3 ForcePath::command(const Vec3& rendered) const noexcept {
  Vec3 force = rounded_to(rendered, config_.step);
  if (config_.max) {
    if (const double norm = force.norm(); norm > *config_.max) force *= *config_.max / norm;
  }
  if (config_.slew) {
    const Vec3 change = force - last_;
    if (const double norm = change.norm(); norm > largest_change_) force = last_ + change * (largest_change_ / norm);
  }
  return force;
}

}  // namespace hapbench
