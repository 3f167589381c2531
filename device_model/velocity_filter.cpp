#include "device_model/velocity_filter.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

VelocityFilter::VelocityFilter(const VelocityFilterConfig& config, double dt) : config_(config), dt_(dt) {
  if (const auto* low_pass = std::get_if<LowPassFilter>(&config)) low_pass_.emplace(*low_pass, dt);
}

void VelocityFilter::reset(const Vec3& position) noexcept {
  samples_[0] = position;
  next_ = known_ = 1;
  velocity_.setZero();
  if (low_pass_) low_pass_->settle_at(velocity_);
}

Vec3 VelocityFilter::read(const Vec3& position) noexcept {
  samples_[next_] = position;
  next_ = (next_ + 1) % samples_.size();
  known_ = std::min(known_ + 1, samples_.size());
  if (const auto* window = std::get_if<AdaptiveWindowFilter>(&config_)) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) velocity_[axis] = end_fit(axis, window->noise);
    return velocity_;
  }
  const Vec3 difference = (position - sample(1)) / dt_;
  velocity_ = low_pass_ ? low_pass_->filter(difference) : difference;
  return velocity_;
}

double VelocityFilter::end_fit(Eigen::Index axis, double noise) const noexcept {
  const double now = sample(0)[axis];
  double rise = 0.0;  // of the line per sample
  for (std::size_t n = 1; n < known_; ++n) {
    const double longer = (now - sample(n)[axis]) / static_cast<double>(n);
    for (std::size_t i = 1; i < n; ++i) {
      if (std::abs(now - longer * static_cast<double>(i) - sample(i)[axis]) > noise) return rise / dt_;
    }
    rise = longer;
  }
  return rise / dt_;
}

}  // namespace hapbench
