#pragma once

#include <Eigen/Geometry>

#include "sim/core/types.hpp"

namespace hapbench {

/// Unit normal of the triangle on the side from which its corners go counter-clockwise; zero if it has no area.
inline Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  return length > 0.0 ? Vec3(normal / length) : Vec3::Zero();
}

}  // namespace hapbench
