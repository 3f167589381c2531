#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "sim/core/math.hpp"
#include "sim/core/types.hpp"

/// Rotations in space and their rotation vectors [rad], in the world frame. After a further rotation by the rotation
/// vector w, a rotation R becomes turn_by(w) R.
namespace hapbench::six_dof {

/// Returns the matrix [v] with [v] w = v x w.
inline Mat3 cross_matrix(const Vec3& v) noexcept {
  Mat3 cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

/// Returns the rotation with this rotation vector (Exp).
inline Eigen::Quaterniond turn_by(const Vec3& w) noexcept {
  const double angle = w.norm();
  const auto [sine, cosine] = math::sine_cosine(0.5 * angle);
  // The limit of sin(angle / 2) / angle is 1/2.
  Eigen::Quaterniond q;
  q.w() = cosine;
  q.vec() = (angle > 0.0 ? sine / angle : 0.5) * w;
  return q;
}

/// Returns the rotation vector of the rotation from `from` to `to` (Log), with an angle of at most pi.
inline Vec3 turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept {
  Eigen::Quaterniond q = to * from.conjugate();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();  // sine of half the angle
  return sine > 0.0 ? Vec3(q.vec() * (2.0 * math::atan2(sine, q.w()) / sine)) : Vec3::Zero();
}

/// Returns the rotation after a further rotation by w, as a unit quaternion.
inline Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Vec3& w) noexcept {
  return (turn_by(w) * rotation).normalized();
}

/// Returns the derivative D of the rotation vector v with respect to a rotation w that is applied after it: Log(Exp(w)
/// Exp(v)) = v + D w + O(w^2). D is the inverse of the left Jacobian of SO(3). Its transpose is the derivative with
/// respect to a rotation that is applied before v. D v = v.
inline Mat3 rotation_vector_derivative(const Vec3& v) noexcept {
  const double angle = v.norm();
  // (1 - (angle / 2) cot(angle / 2)) / angle^2 = 1/12 + angle^2 / 720 + O(angle^4). At 1e-2 rad, the relative error of
  // the series is 1e-13, while the closed form loses 12 of 16 digits.
  double second = 1.0 / 12.0 + angle * angle / 720.0;
  if (angle > 1e-2) {
    const auto [sine, cosine] = math::sine_cosine(0.5 * angle);
    second = (1.0 - 0.5 * angle * cosine / sine) / (angle * angle);
  }
  const Mat3 cross = cross_matrix(v);
  return Mat3::Identity() - 0.5 * cross + second * (cross * cross);
}

}  // namespace hapbench::six_dof
