#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "sim/core/types.hpp"

namespace hapbench {

/// The rotation vector that turns unit vector a to unit vector b the short way [rad]; zero for opposite ones.
inline Vec3 turn(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 cross = a.cross(b);
  const double sine = cross.norm();
  return sine > 0.0 ? Vec3(cross * (std::atan2(sine, a.dot(b)) / sine)) : Vec3::Zero();
}

}  // namespace hapbench
