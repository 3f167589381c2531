#include "sim/loop/integrators/linearly_implicit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace hapbench {
namespace {

/// Solves (M I + resistance) dv = impulse for a symmetric `resistance` [kg], the impulse in N s; finite for finite
/// arguments whose quotients by M are finite.
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

}  // namespace

void implicit_euler(ToolState& tool, const Vec3& force, const ForceJacobian& jacobian, double mass,
                    double dt) noexcept {
  const auto& [K, D] = jacobian;
  tool.velocity += velocity_change(dt * D + dt * dt * K, dt * (force - dt * (K * tool.velocity)), mass);
  tool.pose.position += dt * tool.velocity;
}

void implicit_midpoint(ToolState& tool, const Vec3& force, const ForceJacobian& jacobian, double mass,
                       double dt) noexcept {
  const auto& [K, D] = jacobian;
  const double half = 0.5 * dt;
  const Vec3 change = velocity_change(half * D + half * half * K, dt * (force - half * (K * tool.velocity)), mass);
  tool.pose.position += dt * (tool.velocity + 0.5 * change);
  tool.velocity += change;
}

}  // namespace hapbench
