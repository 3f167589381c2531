#pragma once

#include <cstdint>
#include <optional>

#include "algorithms/rendering_config.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {

/// The bristle as a spring and a damper, K_t and B_t = 2 zeta_t sqrt(K_t M), as which leapfrog steps it while the tool
/// sticks: f = -K_t (e + dt v) - B_t v and e <- e + dt v.
SpringDamper bristle_of(const DryFrictionConfig& config, const RenderingConfig& rendering, double dt) noexcept;

/// Dry friction: one bristle e [m] for the whole tool, which sticks until its force reaches mu N and slides above, with
/// N = sum N_i over the loads N_i = K c_i d_i > 0 of the contacts (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto 2006,
/// whose one contact we extend to many); kDampingAndLimitsInfo has the formula. One face, a slot of two faces and the
/// line of a wedge give Coulomb's force, a corner never more. Guarantee: passive for any motion, loads and normals,
/// -<f, p_k - p_k-1> >= K_t/2 (||e_k||^2 - ||e_k-1||^2) where v is (p_k - p_k-1) / dt. Known failure: an explicit step
/// is stable up to a K_t of the order of K's limit; beyond, a sticking tool chatters, within the bound of mu N.
class DryFriction {
 public:
  DryFriction(const DryFrictionConfig& config, const RenderingConfig& rendering);

  void prepare(const Scene& scene) noexcept {
    dt_ = scene.dt;
    row_ = scene.row;
  }
  /// Forgets the bristle: at the start of a run and where no contact has load.
  void release() noexcept;

  /// f [N] at the tool's velocity v [m/s]; `loads` is sum N_i u_i u_i^T [N], whose trace is N. The bristle moves once a
  /// row: further states of an integrator within the row see the bristle of the row before.
  Vec3 force(const Mat3& loads, const Vec3& v) noexcept;

  /// -df/dv of the last force [N s/m]; while the tool slides, with the cut held.
  Mat3 damping_matrix() const noexcept;
  double energy() const noexcept { return 0.5 * K_t_ * bristle_.squaredNorm(); }  ///< in the bristle [J]
  Friction state() const noexcept { return state_; }

 private:
  double mu_, K_t_, B_t_;
  double dt_ = 0.0005;
  const std::uint64_t* row_ = nullptr;  ///< null without a simulation; then each force is a row's
  std::optional<std::uint64_t> last_row_;
  Vec3 bristle_ = Vec3::Zero(), before_ = Vec3::Zero();  ///< at the end of this row and of the row before
  Mat3 tangential_ = Mat3::Zero();                       ///< P of the last force
  double cut_ = 0.0;                                     ///< what g was multiplied by
  Friction state_ = Friction::none;
};

extern const ModelInfo kDampingAndLimitsInfo;

/// The velocity of the tool at its contacts [m/s]. For a tool that does not turn: v and S v.
struct ContactVelocity {
  Vec3 mean = Vec3::Zero();    ///< mean velocity of the tool's material at the contacts
  Vec3 normal = Vec3::Zero();  ///< v_n, on which normal damping acts
};

/// B of the normal damping [N s/m]: `config.damping`, or 2 zeta sqrt(K M).
double normal_damping(const RenderingConfig& config) noexcept;

/// One load ||f|| along the force f, as sum N_i u_i u_i^T [N]; zero for no force.
Mat3 load_along(const Vec3& force) noexcept;

/// The force, scaled down to the length `most` [N], if there is one.
inline Vec3 cut_to(const Vec3& force, const std::optional<double>& most) noexcept {
  const double length = most ? force.norm() : 0.0;
  return most && length > *most ? Vec3(force * (*most / length)) : force;
}

/// Damping, friction and limits, the same for every law (thesis 2.5, 2.6, A.2.1, B.2, C.4.3), by the formulas of
/// kDampingAndLimitsInfo. The friction coefficients mu_s and mu_f are viscous, although the thesis calls them Coulomb
/// friction.
///
/// With angular damping (thesis 4.4: a tool that only turns is not damped) v is the velocity of the tool's material,
/// v_i = v + omega x r_i at the contact r_i from the tip centre. omega is that of the step before, through a low-pass,
/// because a trembling hand turns the tool much faster than it moves it. The mean arm r_mean is weighted by c_i; laws
/// that are not weighted springs define v_n by ForceLaw::turning_velocity.
/// Guarantee: the dampers of weighted springs take the power B sum c_i <v_i, u_i>^2 >= 0 from the motion of the tool.
/// Known failure: a turn drives the tip sideways with energy of the turning hand, which the hand does not feel, because
/// the device renders translation only.
///
/// Hunt and Crossley's damping and DryFriction, both ours, read the loads N_i = K c_i d_i > 0 of the contacts, for
/// algorithms without weights one load ||f_spring|| along f_spring. The former keeps the force continuous at contact on
/// and off and never pulls while |<v, u_i>| < 1 / chi.
class DampingAndLimits {
 public:
  explicit DampingAndLimits(const RenderingConfig& config);

  void prepare(const Scene& scene) noexcept {
    if (dry_friction_) dry_friction_->prepare(scene);
  }
  /// At the start of a run, and in steps without contact.
  void release() noexcept {
    if (dry_friction_) dry_friction_->release();
  }

  /// True when `rendered_force` reads loads.
  bool needs_loads() const noexcept { return dry_friction_ || config_.hunt_crossley; }
  /// f_render [N] from f_spring [N], S, the velocity of the tool and sum N_i u_i u_i^T [N], which is read
  /// only if needs_loads(). Eigenvalues are computed only if damping is limited. Zero friction is computed only with
  /// Skips::off.
  Vec3 rendered_force(const Vec3& spring, const Mat3& S, const ContactVelocity& velocity,
                      const Mat3& loads = Mat3::Zero()) noexcept;

  /// -df_render/dv [N s/m] without the force limit: B S + (mu_s + mu_f |f_spring|)(I - S), or what stands for the two.
  Mat3 damping_matrix(const Vec3& spring, const Mat3& S) const noexcept;

  /// Cut-off frequency of the low-pass on the tool's angular velocity [Hz]; empty without angular damping.
  const std::optional<double>& angular_velocity_cutoff() const noexcept { return angular_velocity_cutoff_; }
  double stored_energy() const noexcept { return dry_friction_ ? dry_friction_->energy() : 0.0; }  ///< of friction [J]
  Friction friction_state() const noexcept { return dry_friction_ ? dry_friction_->state() : Friction::none; }

 private:
  /// B, or 1 for chi N_i, cut so that no eigenvalue of it times the tensor is above the limit.
  double limited_damping(const Mat3& S) const noexcept;
  double friction(const Vec3& spring) const noexcept { return config_.mu_s + config_.mu_f * spring.norm(); }

  RenderingConfig config_;
  double B_;
  std::optional<DryFriction> dry_friction_;
  Mat3 damping_ = Mat3::Zero();  ///< of Hunt and Crossley, chi sum N_i u_i u_i^T of the last force, limited [N s/m]
  std::optional<double> angular_velocity_cutoff_;
};

}  // namespace hapbench
