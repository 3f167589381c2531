#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// Loose triangles, as in files: in any winding, with repeated or unused vertices.
struct TriangleSoup {
  using Triangle = std::array<std::uint32_t, 3>;  ///< indices of its vertices
  std::vector<Vec3> vertices;                     ///< [m]
  std::vector<Triangle> triangles;
};

/// Unit normal on the side from which the corners are counter-clockwise; zero for a triangle without area.
inline Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  return length > 0.0 ? Vec3(normal / length) : Vec3::Zero();
}

}  // namespace hapbench
