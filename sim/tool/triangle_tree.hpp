#pragma once

#include <limits>
#include <vector>

#include "sim/tool/closed_surface.hpp"

namespace hapbench {

/// Triangles in a tree of bounding boxes, for exact distances and rays. A query takes some O(log n) boxes.
class TriangleTree {
 public:
  /// O(n log n).
  explicit TriangleTree(const ClosedSurface& surface);

  /// The square of the distance of the nearest triangle [m^2], or `bound2` if that is smaller: a known distance that
  /// the nearest one cannot exceed makes the search short.
  double squared_distance(const Vec3& point, double bound2 = std::numeric_limits<double>::infinity()) const noexcept;
  /// How far along the unit direction the ray meets the first triangle beyond `from` [m]; infinity if it meets none.
  double first_hit(const Vec3& origin, const Vec3& direction, double from) const noexcept;

 private:
  struct Corners {
    Vec3 a, b, c;
    Vec3 low() const { return a.cwiseMin(b).cwiseMin(c); }
    Vec3 high() const { return a.cwiseMax(b).cwiseMax(c); }
  };
  /// A leaf holds triangles first … first + count - 1; an inner node has the children first and first + 1.
  struct Node {
    Vec3 low, high;
    std::uint32_t first, count;
  };
  void split(std::size_t node);
  static double squared_distance(const Corners& t, const Vec3& point) noexcept;
  static double squared_distance(const Node& node, const Vec3& point) noexcept;

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace hapbench
