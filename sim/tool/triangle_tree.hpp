#pragma once

#include <vector>

#include "sim/tool/closed_surface.hpp"

namespace hapbench {

/// Triangles in a tree of bounding boxes, for exact distances and rays. A query visits about O(log n) boxes.
class TriangleTree {
 public:
  /// O(n log n).
  explicit TriangleTree(const ClosedSurface& surface);

  /// Lowers each of eight numbers to the squared distance of a point from its nearest triangle [m^2]. The points should
  /// be neighbours, because they share the search. Initial numbers close to the result shorten the search; infinity is
  /// allowed. Aligned to packs of eight (sim/core/simd.hpp).
  void lower_to_squared_distances(const double* x, const double* y, const double* z, double* distances2) const noexcept;
  /// Distance along the unit direction to the first triangle beyond `from` [m]; infinity if there is none.
  double first_hit(const Vec3& origin, const Vec3& direction, double from) const noexcept;

 private:
  /// A triangle with precomputed terms of its distances.
  struct Triangle {
    Vec3 a, ab, ac;
    Vec3 normal;                       ///< unit, zero without an area
    double ab2, abac, ac2;             ///< products of the sides
    double per_ab2, per_bc2, per_ac2;  ///< over squared lengths
    double per_area;                   ///< over the squared area of the parallelogram; NaN without an area
    Triangle(const Vec3& a, const Vec3& b, const Vec3& c);
    Vec3 low() const { return a + ab.cwiseMin(ac).cwiseMin(0.0); }
    Vec3 high() const { return a + ab.cwiseMax(ac).cwiseMax(0.0); }
  };
  /// A leaf holds triangles first … first + count - 1; an inner node has the children first and first + 1.
  struct Node {
    Vec3 low, high;
    std::uint32_t first, count;
  };
  void split(std::size_t node);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace hapbench
