#pragma once

#include <cstdint>
#include <optional>

#include "algorithms/rendering_config.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/loop/integrators/spring_damper.hpp"

namespace hapbench {

/// The bristle as a spring and a damper, K_t and B_t = 2 zeta_t sqrt(K_t M). While the tool sticks, leapfrog steps it
/// as it does a spring: f = -K_t (e + dt v) - B_t v and e <- e + dt v.
SpringDamper bristle_of(const DryFrictionConfig& config, const RenderingConfig& rendering, double dt) noexcept;

/// Dry friction: one bristle e [m] for the whole tool, which sticks until its force reaches mu N and slides above, with
/// N = sum N_i over the loads N_i = K c_i d_i > 0 of the contacts (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto 2006,
/// whose one contact we extend to many). With w_i = N_i / N and P = I - sum w_i u_i u_i^T:
///
///   g  = K_t e + (K_t dt + B_t) P v;   cut to ||g|| <= mu N
///   e <- (dt g + B_t e) / (K_t dt + B_t);   f = -P g,   B_t = 2 zeta_t sqrt(K_t M)
///
/// One face, a slot of two faces and the line of a wedge give Coulomb's force, a corner never more. Guarantee: passive
/// for any motion, loads and normals, -<f, p_k - p_k-1> >= K_t/2 (||e_k||^2 - ||e_k-1||^2) where v is
/// (p_k - p_k-1) / dt. Known failure: an explicit step is stable up to a K_t of the order of K's limit; beyond, a
/// sticking tool chatters, within the bound of mu N.
class DryFriction {
 public:
  DryFriction(const DryFrictionConfig& config, const RenderingConfig& rendering);

  void prepare(const Scene& scene) noexcept;
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

}  // namespace hapbench
