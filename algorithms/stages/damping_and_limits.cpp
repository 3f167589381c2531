#include "algorithms/stages/damping_and_limits.hpp"

#include <cmath>
#include <limits>

#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

SpringDamper bristle_of(const DryFrictionConfig& config, const RenderingConfig& rendering, double dt) noexcept {
  const double K = config.stiffness.value_or(rendering.stiffness);
  return {.K = K, .B = 2.0 * config.damping_ratio * std::sqrt(K * rendering.mass), .M = rendering.mass, .dt = dt};
}

DryFriction::DryFriction(const DryFrictionConfig& config, const RenderingConfig& rendering)
    : mu_(config.mu), K_t_(bristle_of(config, rendering, 0.0).K), B_t_(bristle_of(config, rendering, 0.0).B) {}

void DryFriction::release() noexcept {
  bristle_.setZero();
  previous_bristle_.setZero();
  last_row_.reset();
  slip_scale_ = 0.0;
  state_ = Friction::none;
}

Vec3 DryFriction::force(const Mat3& loads, const Vec3& v) noexcept {
  // No friction without load.
  const double load = loads.trace(), resistance = K_t_ * dt_ + B_t_;
  if (!(load > 0.0) || resistance == 0.0) {
    release();
    return Vec3::Zero();
  }
  const bool first_of_row = row_ == nullptr || last_row_ != *row_;
  if (first_of_row) {
    previous_bristle_ = bristle_;
    if (row_ != nullptr) last_row_ = *row_;
  }
  // Predict the bristle's force at the end of the step and limit it to mu N.
  tangential_ = Mat3::Identity() - loads / load;
  Vec3 g = K_t_ * previous_bristle_ + resistance * (tangential_ * v);
  const double size = g.norm(), limit = mu_ * load;
  slip_scale_ = size > limit ? limit / size : 1.0;
  g *= slip_scale_;
  if (first_of_row) {
    // Set the deflection of the bristle that gives this force.
    bristle_ = (dt_ * g + B_t_ * previous_bristle_) / resistance;
    state_ = slip_scale_ < 1.0 ? Friction::slides : Friction::sticks;
  }
  return -(tangential_ * g);
}

Mat3 DryFriction::damping_matrix() const noexcept {
  return slip_scale_ * (K_t_ * dt_ + B_t_) * tangential_ * tangential_;
}

constexpr ParameterInfo kDampingParameters[] = {
    {parameter::kDampingRatio, "zeta of one spring-damper of stiffness K"},
    {parameter::kDamping, "B, damping; null: computed from zeta"},
    {parameter::kAngularDamping,
     "uses the velocity of the tool's material at each contact, v + omega x r_i, in place of the tip centre's"},
    {parameter::kAngularVelocityCutoff,
     "cutoff frequency of a first-order low-pass of the angular velocity used by angular_damping; null: none"},
    {parameter::kMass, "M, mass of the virtual tool; default 0.2 in planar scenes, else 0.1"},
    {parameter::kMuS, "mu_s, viscous friction; default 0 for springs, else 5"},
    {parameter::kMuF, "mu_f, viscous friction per newton of spring force; default 0 for springs, else 10"},
    {parameter::kDryMu, "mu, coefficient of dry friction, in place of mu_s and mu_f"},
    {parameter::kDryStiffness, "K_t, stiffness of the bristle of dry friction; null: K"},
    {parameter::kDryDampingRatio, "zeta_t, damping ratio of this bristle with the virtual mass"},
    {parameter::kChi, "chi of Hunt-Crossley damping, in place of B"},
    {parameter::kMaxDamping, "B_max, largest damping; null: no limit"},
    {parameter::kMaxForce, "F_max, largest norm of the rendered force; null: no limit"},
};

const ModelInfo kDampingAndLimitsInfo = {
    .name = "damping_and_limits",
    .summary = "normal damping, tangential friction and optional limits, the same for every algorithm",
    .formula =
        "f_dn = -B S v, B = 2 zeta sqrt(K M); f_dt = -(mu_s + mu_f |f_spring|)(v - S v); B scaled to lambda_max(B S) "
        "<= B_max; |f_render| <= F_max. With angular_damping, S v + sum c_i <omega x r_i, u_i> u_i replaces S v, and v "
        "+ omega x r_mean replaces v. Hunt-Crossley damping: f_dn = -chi sum N_i <v, u_i> u_i, N_i = K c_i d_i. Dry "
        "friction: g = K_t e + (K_t dt + B_t) P v, limited to mu sum N_i, P = I - sum N_i u_i u_i^T / sum N_i, e <- "
        "(dt g + B_t e) / (K_t dt + B_t), f_dt = -P g",
    .source =
        "thesis 2.5, 2.6, A.2.1, B.2, C.4.3; mu_s and mu_f, called Coulomb friction there, are viscous; "
        "angular_damping is not in the thesis and follows the future work of 4.3 and 4.4; dry friction after Kikuuwe "
        "et al. 2006, damping that grows with depth after Hunt and Crossley 1975",
    .known_failure =
        "without angular_damping, a tool that only rotates has no velocity to damp (thesis 4.4); with it, a rotation "
        "pushes the tip sideways, because no torque is rendered; limits leave stiff scenes under-damped (A.2); the "
        "bristle of dry friction chatters if the explicit step is unstable with K_t",
    .parameters = kDampingParameters,
};

double normal_damping(const RenderingConfig& config) noexcept {
  return config.damping.value_or(2.0 * config.damping_ratio * std::sqrt(config.stiffness * config.mass));
}

Mat3 load_along(const Vec3& force) noexcept {
  const double size = force.norm();
  return size > 0.0 ? Mat3(force * force.transpose() / size) : Mat3(Mat3::Zero());
}

DampingAndLimits::DampingAndLimits(const RenderingConfig& config)
    : config_(config), B_(config.hunt_crossley ? 1.0 : normal_damping(config)) {
  constexpr double kUnfiltered = std::numeric_limits<double>::infinity();
  if (config.angular_damping) angular_velocity_cutoff_ = config.angular_velocity_cutoff.value_or(kUnfiltered);
  if (config.dry_friction) dry_friction_.emplace(*config.dry_friction, config);
}

double DampingAndLimits::limited_damping(const Mat3& S) const noexcept {
  const std::optional<double>& limit = config_.max_damping;
  const double largest = limit ? B_ * lambda_max(S) : 0.0;
  return limit && largest > *limit ? B_ * (*limit / largest) : B_;
}

Mat3 DampingAndLimits::damping_matrix(const Vec3& spring, const Mat3& S) const noexcept {
  Mat3 damping = config_.hunt_crossley ? damping_ : Mat3(limited_damping(S) * S);
  if (dry_friction_) return damping + dry_friction_->damping_matrix();
  return damping + friction(spring) * (Mat3::Identity() - S);
}

Vec3 DampingAndLimits::rendered_force(const Vec3& spring, const Mat3& S, const ContactVelocity& velocity,
                                      const Mat3& loads) noexcept {
  Vec3 force;
  if (config_.hunt_crossley) {
    damping_ = *config_.hunt_crossley * loads;
    damping_ *= limited_damping(damping_);
    force = spring - damping_ * velocity.mean;
  } else {
    force = spring - limited_damping(S) * velocity.normal;
  }
  const auto tangential = [&]() -> Vec3 { return friction(spring) * (velocity.mean - velocity.normal); };
  if (dry_friction_) {
    force += dry_friction_->force(loads, velocity.mean);
  } else if (config_.mu_s != 0.0 || config_.mu_f != 0.0) {
    force -= tangential();
  } else if (config_.skips == Skips::off) {
    // Adding zero turns -0 into 0. Subtracting -0 would turn a force of -0 into 0.
    force -= tangential() + Vec3::Zero();
  }
  return limited_to(force, config_.max_force);
}

}  // namespace hapbench
