#pragma once

#include <cstdint>
#include <optional>

#include "algorithms/rendering_config.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {

/// Returns the bristle of dry friction as a spring-damper with stiffness K_t and damping B_t = 2 zeta_t
/// sqrt(K_t M). While the tool sticks, dry friction acts like this spring-damper under leapfrog: f = -K_t (e + dt v)
/// - B_t v and e <- e + dt v.
SpringDamper bristle_of(const DryFrictionConfig& config, const RenderingConfig& rendering, double dt) noexcept;

/// Dry friction with one bristle of deflection e [m] for the whole tool (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto
/// 2006; their model has a single contact, this class has many). The tool sticks until the bristle's force reaches mu
/// N, and slides above it. N = sum N_i is the sum of the contact loads N_i = K c_i d_i > 0. Formula:
/// kDampingAndLimitsInfo.
///
/// On one face, between the two faces of a slot and along the line of a wedge, the result is Coulomb's friction force.
/// In a corner, the result is at most Coulomb's friction force. Guarantee: passive for any motion, loads and normals,
/// -<f, p_k - p_k-1> >= K_t/2 (||e_k||^2 - ||e_k-1||^2) if the velocity v passed to `force` is (p_k - p_k-1) / dt.
/// Known failure: with an explicit integrator, the bristle is stable only up to a K_t of about the stability limit of
/// the penalty stiffness K. Beyond this K_t, a sticking tool chatters with forces of at most mu N.
class DryFriction {
 public:
  DryFriction(const DryFrictionConfig& config, const RenderingConfig& rendering);

  void prepare(const Scene& scene) noexcept {
    dt_ = scene.dt;
    row_ = scene.row;
  }
  /// Resets the bristle. Called at the start of a run and in steps in which no contact has a load.
  void release() noexcept;

  /// Returns the friction force [N] at the tool's velocity v [m/s]. `loads` is sum N_i u_i u_i^T [N], whose
  /// trace is N. The bristle moves once in every step. Further states of an integrator within the step use the
  /// bristle of the previous step.
  Vec3 force(const Mat3& loads, const Vec3& v) noexcept;

  /// Returns -df/dv of the last force [N s/m]. While the tool slides, the scaling to mu N is held constant.
  Mat3 damping_matrix() const noexcept;
  double energy() const noexcept { return 0.5 * K_t_ * bristle_.squaredNorm(); }  ///< elastic energy of the bristle [J]
  Friction state() const noexcept { return state_; }

 private:
  double mu_, K_t_, B_t_;
  double dt_ = 0.0005;
  const std::uint64_t* row_ = nullptr;  ///< null if no Simulation steps the algorithm; then each call counts as a step
  std::optional<std::uint64_t> last_row_;
  /// Deflection e at the end of this step, and of the previous step [m].
  Vec3 bristle_ = Vec3::Zero(), previous_bristle_ = Vec3::Zero();
  /// P = I - sum N_i u_i u_i^T / N of the last force. If all u_i are parallel, P projects onto the tangential plane.
  Mat3 tangential_ = Mat3::Zero();
  /// Factor in [0, 1] that limits the force to mu N; 1 while the tool sticks, 0 without load.
  double slip_scale_ = 0.0;
  Friction state_ = Friction::none;
};

extern const ModelInfo kDampingAndLimitsInfo;

/// Velocity of the tool at its contacts [m/s]. For a tool that translates with velocity v, `mean` is v and `normal`
/// is S v.
struct ContactVelocity {
  Vec3 mean = Vec3::Zero();    ///< mean velocity of the tool's material at the contacts
  Vec3 normal = Vec3::Zero();  ///< v_n, velocity for normal damping
};

/// Returns B of the normal damping [N s/m]: `config.damping`, or 2 zeta sqrt(K M).
double normal_damping(const RenderingConfig& config) noexcept;

/// Returns the load tensor f f^T / ||f|| [N] of a single load ||f|| along the force f; zero for zero force.
Mat3 load_along(const Vec3& force) noexcept;

/// Returns `force` [N], scaled down to the norm `limit` [N] if its norm is larger. Returns `force` unchanged if `limit`
/// is nullopt.
inline Vec3 limited_to(const Vec3& force, const std::optional<double>& limit) noexcept {
  const double length = limit ? force.norm() : 0.0;
  return limit && length > *limit ? Vec3(force * (*limit / length)) : force;
}

/// Damping, friction and limits, identical for all laws (thesis sections 2.5, 2.6, A.2.1, B.2, C.4.3). Formulas and
/// symbols: kDampingAndLimitsInfo. The friction coefficients mu_s and mu_f are viscous, although the thesis calls them
/// Coulomb friction.
///
/// Without angular damping, a tool that only rotates is not damped (thesis section 4.4). With angular damping, the
/// velocity at contact i is the velocity of the tool's material at this contact, v_i = v + omega x r_i, where r_i is
/// the vector from the tip centre to the contact. omega is the angular velocity of the previous step after a low-pass
/// filter. The filter is needed because, when the hand trembles, the velocities omega x r_i are much larger than v.
/// `ContactVelocity::mean` uses the mean of the arms r_i with the weights c_i of the contacts. u_i is the gradient of
/// contact i. For a law that is not made of weighted springs, ForceLaw::turning_velocity defines the normal velocity.
///
/// Guarantee: the dampers of weighted springs take the power B sum c_i <v_i, u_i>^2 >= 0 from the motion of the tool.
///
/// Known failure: if the hand rotates the tool, the damping pushes the tip sideways. The energy comes from the hand's
/// rotation, but the hand feels no torque against it, because the device renders no torque.
///
/// Hunt and Crossley's damping and DryFriction (our additions) use the loads N_i = K c_i d_i > 0 of the
/// contacts, with the depths d_i [m]. For algorithms without weights they use one load ||f_spring|| along f_spring.
/// Hunt and Crossley's damping keeps the force continuous at contact onset and release, and never pulls while |<v,
/// u_i>| < 1 / chi, with the coefficient chi.
class DampingAndLimits {
 public:
  explicit DampingAndLimits(const RenderingConfig& config);

  void prepare(const Scene& scene) noexcept {
    if (dry_friction_) dry_friction_->prepare(scene);
  }
  /// Resets dry friction. Called at the start of a run and in steps without contact.
  void release() noexcept {
    if (dry_friction_) dry_friction_->release();
  }

  /// Returns true if `rendered_force` reads `loads`.
  bool needs_loads() const noexcept { return dry_friction_ || config_.hunt_crossley; }
  /// Returns f_render [N]. Arguments: f_spring [N], the stiffness tensor S in units of K, the velocity of the tool
  /// [m/s], and the load tensor sum N_i u_i u_i^T [N], which is read only if needs_loads(). Eigenvalues are computed
  /// only if damping is limited. Friction with zero coefficients is computed only with Skips::off.
  Vec3 rendered_force(const Vec3& spring, const Mat3& S, const ContactVelocity& velocity,
                      const Mat3& loads = Mat3::Zero()) noexcept;

  /// Returns -df_render/dv [N s/m] without the limit of the force: B S + (mu_s + mu_f |f_spring|)(I - S). S is the
  /// stiffness tensor in units of K. mu_s [N s/m] and mu_f [s/m] are the coefficients of viscous friction. Hunt and
  /// Crossley's damping replaces the first term, dry friction replaces the second term; both use the loads of the last
  /// call of `rendered_force`. The limit of the damping, max_damping, is applied.
  Mat3 damping_matrix(const Vec3& spring, const Mat3& S) const noexcept;

  /// Returns the cut-off frequency of the low-pass on the tool's angular velocity [Hz]; nullopt without angular
  /// damping.
  const std::optional<double>& angular_velocity_cutoff() const noexcept { return angular_velocity_cutoff_; }
  /// Elastic energy of dry friction [J].
  double stored_energy() const noexcept { return dry_friction_ ? dry_friction_->energy() : 0.0; }
  Friction friction_state() const noexcept { return dry_friction_ ? dry_friction_->state() : Friction::none; }

 private:
  /// Returns B [N s/m], scaled down so that no eigenvalue of the returned value times S exceeds max_damping. For Hunt
  /// and Crossley's damping, S is the damping matrix [N s/m], and the returned value is a factor <= 1.
  double limited_damping(const Mat3& S) const noexcept;
  double friction(const Vec3& spring) const noexcept { return config_.mu_s + config_.mu_f * spring.norm(); }

  RenderingConfig config_;
  double B_;
  std::optional<DryFriction> dry_friction_;
  /// Hunt and Crossley's damping chi sum N_i u_i u_i^T of the last force, after the limit max_damping [N s/m].
  Mat3 damping_ = Mat3::Zero();
  std::optional<double> angular_velocity_cutoff_;
};

}  // namespace hapbench
