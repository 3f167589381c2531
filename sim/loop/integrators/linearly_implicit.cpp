#include "sim/loop/integrators/linearly_implicit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace hapbench {

Vec3 velocity_change(const Mat3& resistance, const Vec3& impulse, double mass) noexcept {
  const Mat3 A = Mat3::Identity() + resistance / mass;
  const Vec3 explicit_change = impulse / mass;
  if (!A.allFinite()) return explicit_change;
  // Forces that hold the tool make every eigenvalue 1 or more, to rounding; nearly always this is so.
  if (Eigen::LLT<Mat3>(A - 0.5 * Mat3::Identity()).info() == Eigen::Success) return A.llt().solve(explicit_change);
  const Eigen::SelfAdjointEigenSolver<Mat3> modes(A);
  const Mat3& axes = modes.eigenvectors();
  return axes * (axes.transpose() * explicit_change).cwiseQuotient(modes.eigenvalues().cwiseMax(1.0));
}

}  // namespace hapbench
