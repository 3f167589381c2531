#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Returns the triangles with vertices at the same position merged. Omits triangles with two equal corners. Throws
/// std::invalid_argument if an index is out of range or a coordinate is not finite. O(n log n).
TriangleSoup welded(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

/// Side of a triangle: the directed edge from one corner to the next.
struct TriangleSide {
  std::uint32_t low, high;         ///< indices of its vertices, low < high
  std::uint32_t triangle, corner;  ///< index of the triangle, and the corner (0 to 2) where the side starts
  bool forward;                    ///< true if the side runs from vertex `low` to vertex `high`
};
/// Returns all sides of the triangles, sorted by edge (low, high) and then by triangle.
std::vector<TriangleSide> sides_by_edge(std::span<const TriangleCorners> triangles);

/// Calls `use` once for each edge, with the sides on this edge. Precondition: the sides are sorted as
/// sides_by_edge() sorts them.
template <class Use>
void for_each_edge(std::span<const TriangleSide> sides, const Use& use) {
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;) ++end;
    use(sides.subspan(i, end - i));
  }
}

/// Returns true if equally many sides run along the edge in both directions.
bool is_balanced(std::span<const TriangleSide> edge);

/// Surface that bounds a solid. Its triangles are counter-clockwise seen from outside. On each edge, equally many
/// sides of triangles run in both directions.
class ClosedSurface {
 public:
  /// Builds the surface from welded(vertices, triangles), in O(n log n). Throws std::invalid_argument with the
  /// measured values if an index or a coordinate is invalid, if edges are open or neighbouring triangles are wound
  /// against each other (with the number of such edges and the position of the first), or if the enclosed volume is
  /// not positive. Self-intersections are not detected here; SignedDistanceGrid detects them when it samples the
  /// surface.
  ClosedSurface(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

  const std::vector<Vec3>& vertices() const noexcept { return surface_.vertices; }  ///< [m]
  const std::vector<TriangleCorners>& triangles() const noexcept { return surface_.triangles; }
  std::array<Vec3, 3> corners(const TriangleCorners& t) const {
    return {vertices()[t[0]], vertices()[t[1]], vertices()[t[2]]};
  }
  const Box& box() const noexcept { return box_; }  ///< bounding box of the triangles [m]

 private:
  void check_edges() const;
  void measure();

  TriangleSoup surface_;
  Box box_;
};

/// Nodes of a regular grid. Values at the nodes are stored with z as the fastest index, then y, then x.
struct GridNodes {
  Vec3 origin;     ///< position of node (0, 0, 0) [m]
  double spacing;  ///< [m]
  std::array<std::size_t, 3> count;

  std::size_t size() const noexcept { return count[0] * count[1] * count[2]; }
  std::size_t index(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return (i * count[1] + j) * count[2] + k;
  }
  double coordinate(int axis, std::size_t i) const noexcept { return origin[axis] + spacing * static_cast<double>(i); }
  Vec3 position(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return {coordinate(0, i), coordinate(1, j), coordinate(2, k)};
  }
};

/// Returns the winding number of the surface around each node: 0 outside and 1 inside a valid solid, convex or not.
/// Other values occur where parts of the surface overlap or are inside out.
///
/// The winding number is the sum of the signed intersections of the surface with any ray from the point. Here the rays
/// run along z from below (vertical_crossing), so one sweep over each column of nodes suffices. Runs on oneTBB's
/// threads; the result does not depend on their number. Cost: O(c + n) for n nodes, where c is the number of pairs of a
/// triangle and a column of nodes that the triangle covers.
std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes);

}  // namespace hapbench
