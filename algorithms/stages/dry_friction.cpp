#include "algorithms/stages/dry_friction.hpp"

#include <cmath>

namespace hapbench {

SpringDamper bristle_of(const DryFrictionConfig& config, const RenderingConfig& rendering, double dt) noexcept {
  const double K = config.stiffness.value_or(rendering.stiffness);
  return {.K = K, .B = 2.0 * config.damping_ratio * std::sqrt(K * rendering.mass), .M = rendering.mass, .dt = dt};
}

DryFriction::DryFriction(const DryFrictionConfig& config, const RenderingConfig& rendering)
    : mu_(config.mu), K_t_(bristle_of(config, rendering, 0.0).K), B_t_(bristle_of(config, rendering, 0.0).B) {}

void DryFriction::prepare(const Scene& scene) noexcept {
  dt_ = scene.dt;
  row_ = scene.row;
}

void DryFriction::release() noexcept {
  bristle_.setZero();
  before_.setZero();
  last_row_.reset();
  cut_ = 0.0;
  state_ = Friction::none;
}

Vec3 DryFriction::force(const Mat3& loads, const Vec3& v) noexcept {
  const double load = loads.trace(), resistance = K_t_ * dt_ + B_t_;
  if (!(load > 0.0) || resistance == 0.0) {
    release();
    return Vec3::Zero();
  }
  const bool first_of_row = row_ == nullptr || last_row_ != *row_;
  if (first_of_row) {
    before_ = bristle_;
    if (row_ != nullptr) last_row_ = *row_;
  }
  tangential_ = Mat3::Identity() - loads / load;
  Vec3 g = K_t_ * before_ + resistance * (tangential_ * v);
  const double size = g.norm(), most = mu_ * load;
  cut_ = size > most ? most / size : 1.0;
  g *= cut_;
  if (first_of_row) {
    bristle_ = (dt_ * g + B_t_ * before_) / resistance;
    state_ = cut_ < 1.0 ? Friction::slides : Friction::sticks;
  }
  return -(tangential_ * g);
}

Mat3 DryFriction::damping_matrix() const noexcept {
  return cut_ * (K_t_ * dt_ + B_t_) * tangential_ * tangential_;
}

}  // namespace hapbench
