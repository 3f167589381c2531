#include "algorithms/damping_and_limits.hpp"

#include <cmath>

#include "sim/contact/stiffness_tensor.hpp"

namespace hapbench {

DampingAndLimits::DampingAndLimits(const RenderingConfig& config)
    : B_(config.damping.value_or(2.0 * config.damping_ratio * std::sqrt(config.stiffness * config.mass))),
      mu_s_(config.mu_s),
      mu_f_(config.mu_f),
      max_damping_(config.max_damping),
      max_force_(config.max_force) {}

Vec3 DampingAndLimits::rendered_force(const Vec3& spring, const Mat3& S, const Vec3& velocity) const noexcept {
  double B = B_;
  if (max_damping_) {
    const double largest = B_ * lambda_max(S);
    if (largest > *max_damping_) B = B_ * (*max_damping_ / largest);
  }
  const Vec3 normal_velocity = S * velocity;
  Vec3 force = spring - B * normal_velocity;
  if (mu_s_ != 0.0 || mu_f_ != 0.0) force -= (mu_s_ + mu_f_ * spring.norm()) * (velocity - normal_velocity);
  if (max_force_) {
    const double length = force.norm();
    if (length > *max_force_) force *= *max_force_ / length;
  }
  return force;
}

}  // namespace hapbench
