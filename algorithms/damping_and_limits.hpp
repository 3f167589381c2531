#pragma once

#include "algorithms/info.hpp"
#include "algorithms/rendering_config.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

extern const ModelInfo kDampingAndLimitsInfo;

/// Damping, friction and limits, the same for every law (thesis 2.5, 2.6, A.2.1, B.2, C.4.3):
///
///   f_dn = -B S v, B = 2 zeta sqrt(K M);  v_t = v - S v, f_dt = -(mu_s + mu_f |f_spring|) v_t
///
/// Max damping: the normal damping is scaled by B_max / lambda_max(B S) when that is below 1. Max force: f_render is
/// scaled to norm F_max when it is longer. The friction coefficients are viscous, whatever the thesis calls them.
class DampingAndLimits {
 public:
  explicit DampingAndLimits(const RenderingConfig& config);

  /// f_render [N] from f_spring [N], S and the tool's velocity [m/s]. Eigenvalues are computed only when there is
  /// a limit, friction that is none only when skips are off.
  Vec3 rendered_force(const Vec3& spring, const Mat3& S, const Vec3& velocity) const noexcept;

  /// What multiplies minus the velocity in it [N s/m]: B S + (mu_s + mu_f |f_spring|)(I - S); the force limit is left
  /// out.
  Mat3 damping_matrix(const Vec3& spring, const Mat3& S) const noexcept;

  double damping() const { return B_; }  ///< B [N s/m]

 private:
  double limited_damping(const Mat3& S) const noexcept;
  double friction(const Vec3& spring) const noexcept { return mu_s_ + mu_f_ * spring.norm(); }

  double B_;
  double mu_s_;
  double mu_f_;
  std::optional<double> max_damping_;
  std::optional<double> max_force_;
  Skips skips_;
};

}  // namespace hapbench
