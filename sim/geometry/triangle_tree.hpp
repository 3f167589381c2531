#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

using TriangleCorners = std::array<std::uint32_t, 3>;  ///< indices of its vertices

/// Loose triangles, as in files: in any winding, with repeated or unused vertices.
struct TriangleSoup {
  using Triangle = TriangleCorners;
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// Unit normal on the side from which the corners are counter-clockwise; zero for a triangle without area.
inline Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return unit_or((b - a).cross(c - a), Vec3::Zero());
}

/// An order of places: by x, then y, then z.
inline bool before(const Vec3& a, const Vec3& b) noexcept {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// A crossing of the vertical line through (x, y) and a triangle, at which the winding number of the points above
/// changes by `step`.
struct Crossing {
  double z;
  int step;
};

/// Where the vertical line meets a triangle. The signs of three edges decide; they are computed identically for both
/// triangles of an edge, and a line through an edge counts as one slightly off it, so that a closed surface is
/// crossed consistently.
std::optional<Crossing> vertical_crossing(const std::array<Vec3, 3>& corners, double x, double y);

/// Triangles in a tree of bounding boxes, for exact distances and rays. A query visits about O(log n) boxes. A triangle
/// whose corners are one vertex stands for that point.
class TriangleTree {
 public:
  /// O(n log n).
  TriangleTree(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

  /// The place of a triangle that is nearest to a point.
  struct Nearest {
    double distance2;        ///< [m^2]
    std::uint32_t triangle;  ///< its number
    unsigned corners;        ///< bit k: the place is on the side of corner k; all three within the triangle
    Vec3 place;              ///< [m]
  };
  /// The nearest place, if one is nearer than `at_most` [m].
  std::optional<Nearest> nearest(const Vec3& point, double at_most) const noexcept;

  /// Winding number of a closed surface around a point: 1 inside a sound solid, 0 outside. The surface is the one that
  /// the tree was made from.
  int winding_number(const Vec3& point, std::span<const Vec3> vertices,
                     std::span<const TriangleCorners> triangles) const noexcept;

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
    std::uint32_t number;
    Triangle(std::uint32_t number, const Vec3& a, const Vec3& b, const Vec3& c);
  };
  /// A leaf holds triangles first … first + count - 1; an inner node has the children first and first + 1.
  struct Node {
    Vec3 low, high;
    std::uint32_t first, count;
  };
  /// A triangle while the tree is made.
  struct Item {
    Vec3 middle, low, high;  ///< the sum of its corners, and its box
    std::uint32_t number;
  };
  void split(std::size_t node, std::vector<Item>& items);
  template <class DistanceTo, class IsLess, class MayBeNearer, class Use>
  void visit_nearest_first(const DistanceTo& distance_to, const IsLess& is_less, const MayBeNearer& may_be_nearer,
                           const Use& use) const;
  /// Calls `use` with the triangles of the leaves that are reached through nodes for which `enters(node)` is true.
  template <class Enters, class Use>
  void visit(const Enters& enters, const Use& use) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace hapbench
