#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

using TriangleCorners = std::array<std::uint32_t, 3>;  ///< indices of its vertices

/// A surface that bounds a solid: triangles counter-clockwise from outside, every edge passed as often in one direction
/// as in the other.
class ClosedSurface {
 public:
  /// Vertices at the same place become one, triangles with two equal corners are left out. Throws
  /// std::invalid_argument with what was measured when an index or a coordinate is no good, edges are open or their
  /// neighbours wound against each other (how many, and where the first is), or the volume is zero or negative.
  /// O(n log n). Surfaces that pass through themselves are found where a grid samples them (SignedDistanceGrid).
  ClosedSurface(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

  const std::vector<Vec3>& vertices() const noexcept { return vertices_; }  ///< [m]
  const std::vector<TriangleCorners>& triangles() const noexcept { return triangles_; }
  std::array<Vec3, 3> corners(const TriangleCorners& t) const {
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }
  const Vec3& low() const noexcept { return low_; }  ///< corners of its bounding box [m]
  const Vec3& high() const noexcept { return high_; }
  double volume() const noexcept { return volume_; }  ///< [m^3], > 0

 private:
  void weld(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);
  void check_edges() const;
  void measure();

  std::vector<Vec3> vertices_;
  std::vector<TriangleCorners> triangles_;
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
  double volume_ = 0.0;
};

}  // namespace hapbench
