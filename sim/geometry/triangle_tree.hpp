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

using TriangleCorners = std::array<std::uint32_t, 3>;  ///< indices of the triangle's vertices

/// Unconnected triangles, as read from a file: with any winding, and with repeated or unused vertices.
struct TriangleSoup {
  using Triangle = TriangleCorners;
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// Returns the unit normal on the side from which the corners are counter-clockwise; zero if the triangle has no
/// area.
inline Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  return unit_or((b - a).cross(c - a), Vec3::Zero());
}

/// Lexicographic order of points: by x, then y, then z.
inline bool before(const Vec3& a, const Vec3& b) noexcept {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// Intersection of the vertical line through (x, y) with a triangle. The winding number around a point changes by
/// `step` when the point moves upwards through the triangle.
struct Crossing {
  double z;
  int step;
};

/// Returns the intersection of the vertical line through (x, y) with a triangle; empty if they do not intersect. The
/// test determines on which side of each edge the line passes, identically for both triangles at the edge. A line
/// through an edge counts as a line slightly beside the edge. A line therefore enters and leaves a closed surface
/// equally often.
std::optional<Crossing> vertical_crossing(const std::array<Vec3, 3>& corners, double x, double y);

/// Tree of axis-aligned bounding boxes over triangles (AABB tree), for exact distances and rays. A query visits
/// about O(log n) boxes. A triangle with three equal corners represents a point.
class TriangleTree {
 public:
  /// Builds the tree in O(n log n). `triangles` holds indices into `vertices` [m]. Precondition: there is at least
  /// one triangle.
  TriangleTree(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles);

  /// Point on the triangles that is closest to a query point.
  struct Nearest {
    double distance2;        ///< [m^2]
    std::uint32_t triangle;  ///< index of the triangle
    /// Corners of the vertex, edge or face on which `position` lies: bit k is set for corner k. 7 inside the triangle.
    unsigned corners;
    Vec3 position;  ///< [m]
  };
  /// Returns the point of the triangles that is closest to `point`; nullopt if it is not closer than `at_most` [m].
  std::optional<Nearest> nearest(const Vec3& point, double at_most) const noexcept;

  /// Returns the winding number of a closed surface around a point: 1 inside a valid solid, 0 outside.
  /// Precondition: the tree was built from the same `vertices` and `triangles`.
  int winding_number(const Vec3& point, std::span<const Vec3> vertices,
                     std::span<const TriangleCorners> triangles) const noexcept;

  /// Replaces each of eight squared distances [m^2] by the squared distance from its point to the closest triangle,
  /// if that is smaller. The eight points should be close together, because they share one search. Initial values
  /// close to the result shorten the search; infinity is allowed. Precondition: arrays of eight doubles, aligned to
  /// 64 bytes.
  void lower_to_squared_distances(const double* x, const double* y, const double* z, double* distances2) const noexcept;
  /// Returns the distance along the ray to the first triangle at a distance greater than `from` [m]; infinity if the
  /// ray hits no such triangle. Precondition: `direction` is a unit vector.
  double first_hit(const Vec3& origin, const Vec3& direction, double from) const noexcept;

 private:
  /// Triangle with precomputed terms for distance queries; ab and ac are the edge vectors from corner a.
  struct Triangle {
    Vec3 a, ab, ac;
    Vec3 normal;                       ///< unit normal; zero if the triangle has no area
    double ab2, abac, ac2;             ///< dot products of ab and ac
    double per_ab2, per_bc2, per_ac2;  ///< reciprocals of the squared edge lengths
    double per_area;                   ///< 1 / |ab x ac|^2; NaN if the triangle has no area
    std::uint32_t number;
    Triangle(std::uint32_t number, const Vec3& a, const Vec3& b, const Vec3& c);
  };
  /// Node of the tree with the box low … high [m]. A leaf (count > 0) holds the triangles first … first + count -
  /// 1. An inner node (count = 0) has the children `first` and `first + 1`.
  struct Node {
    Vec3 low, high;
    std::uint32_t first, count;
  };
  /// Triangle during the construction of the tree.
  struct Item {
    Vec3 middle, low, high;  ///< sum of the corners [m]; smallest and largest corner of the bounding box [m]
    std::uint32_t number;
  };
  /// Splits a node with too many triangles into two children.
  void split(std::size_t node, std::vector<Item>& items);
  /// Calls `use` with the triangles of the leaves, closest boxes first; skips boxes that cannot contain a closer
  /// point.
  template <class DistanceTo, class IsLess, class MayBeNearer, class Use>
  void visit_nearest_first(const DistanceTo& distance_to, const IsLess& is_less, const MayBeNearer& may_be_nearer,
                           const Use& use) const;
  /// Calls `use` with each triangle of every leaf that is searched. A node is searched only if `enters(node)` is true,
  /// and its children are searched only if the node itself is.
  template <class Enters, class Use>
  void visit(const Enters& enters, const Use& use) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace hapbench
