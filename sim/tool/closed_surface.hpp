#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Triangles whose vertices at the same place are one; those with two equal corners are left out.
struct WeldedSurface {
  std::vector<Vec3> vertices;
  std::vector<TriangleCorners> triangles;
};
/// Throws std::invalid_argument if an index or a coordinate is invalid. O(n log n).
WeldedSurface welded(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

/// A surface that bounds a solid: triangles counter-clockwise from outside, which run along every edge equally often in
/// either direction.
class ClosedSurface {
 public:
  /// Merges vertices at the same place and omits triangles with two equal corners. Throws std::invalid_argument with
  /// the measured values if an index or a coordinate is invalid, edges are open or their neighbours wound against each
  /// other (their number and the first place), or the volume is not positive. O(n log n). Surfaces that pass through
  /// themselves are found by the grid that samples them (SignedDistanceGrid).
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
  void check_edges() const;
  void measure();

  std::vector<Vec3> vertices_;
  std::vector<TriangleCorners> triangles_;
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
  double volume_ = 0.0;
};

/// The nodes of a regular grid, stored column by column along z.
struct GridNodes {
  Vec3 origin;     ///< node (0, 0, 0) [m]
  double spacing;  ///< [m]
  std::array<std::size_t, 3> count;

  std::size_t size() const noexcept { return count[0] * count[1] * count[2]; }
  std::size_t index(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return (i * count[1] + j) * count[2] + k;
  }
  double coordinate(int axis, std::size_t i) const noexcept { return origin[axis] + spacing * static_cast<double>(i); }
  Vec3 place(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return {coordinate(0, i), coordinate(1, j), coordinate(2, k)};
  }
};

/// Winding number of the surface around each node: 0 outside, 1 inside a sound solid, concave or not; other values
/// where parts overlap or are inside out.
///
/// For a closed surface it is the sum of the signed crossings of any ray, here the ray from below along z
/// (vertical_crossing), so one pass over each column of nodes suffices, without normals of edges and vertices. Runs on
/// oneTBB's threads; the result does not depend on their number. Cost: triangles times the columns they cover, plus the
/// nodes.
std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes);

}  // namespace hapbench
