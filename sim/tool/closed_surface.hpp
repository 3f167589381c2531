#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// The triangles with vertices at the same place made one, without those that have two equal corners. Throws
/// std::invalid_argument if an index or a coordinate is invalid. O(n log n).
TriangleSoup welded(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

/// A side of a triangle, from one corner to the next.
struct TriangleSide {
  std::uint32_t low, high;         ///< its vertices, low < high
  std::uint32_t triangle, corner;  ///< where it starts
  bool forward;                    ///< from low to high
};
/// All sides, sorted by edge and, of one edge, by triangle.
std::vector<TriangleSide> sides_by_edge(std::span<const TriangleCorners> triangles);

/// Calls `use` with the sides of each edge. Precondition: they are sorted.
template <class Use>
void for_each_edge(std::span<const TriangleSide> sides, const Use& use) {
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;) ++end;
    use(sides.subspan(i, end - i));
  }
}

/// True if as many triangles run along the edge in one direction as in the other.
bool is_balanced(std::span<const TriangleSide> edge);

/// A surface that bounds a solid: triangles counter-clockwise from outside, which run along every edge equally often in
/// either direction.
class ClosedSurface {
 public:
  /// Of the `welded` triangles. Throws std::invalid_argument with the measured values if an index or a coordinate is
  /// invalid, edges are open or their neighbours wound against each other (their number and the first place), or the
  /// volume is not positive. O(n log n). The grid that samples surfaces finds those that pass through themselves.
  ClosedSurface(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

  const std::vector<Vec3>& vertices() const noexcept { return surface_.vertices; }  ///< [m]
  const std::vector<TriangleCorners>& triangles() const noexcept { return surface_.triangles; }
  std::array<Vec3, 3> corners(const TriangleCorners& t) const {
    return {vertices()[t[0]], vertices()[t[1]], vertices()[t[2]]};
  }
  const Box& box() const noexcept { return box_; }  ///< around the triangles [m]

 private:
  void check_edges() const;
  void measure();

  TriangleSoup surface_;
  Box box_;
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
/// It is the sum of the signed crossings of any ray, here that from below along z (vertical_crossing), so one pass over
/// each column of nodes suffices. Runs on oneTBB's threads; the result does not depend on their number. Cost: triangles
/// times the columns they cover, plus the nodes.
std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes);

}  // namespace hapbench
