#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Thrown if a polygon cannot be divided into triangles. The message states the reason, without the position.
class PolygonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Maximum number of corners of a polygon that is not star-shaped from its first corner. The time to divide it grows
/// with the square of this number.
inline constexpr std::size_t kMaxPolygonCorners = 10'000;
/// Largest allowed distance of a corner from the plane of its polygon, relative to the diameter of the polygon.
/// Polygons with a larger distance are refused.
inline constexpr double kMaxUnevenness = 0.1;

/// Triangles of a polygon.
struct DividedPolygon {
  std::vector<TriangleCorners> triangles;  ///< corners as indices into the polygon, in the winding of the polygon
  double unevenness = 0.0;           ///< largest distance of a corner from the plane, divided by the polygon's diameter
  std::size_t repeated_corners = 0;  ///< omitted corners: repetitions of a neighbour, and tips of spikes without width
};

/// Divides polygons into triangles. One object serves many polygons and reuses its memory.
///
/// The plane of a polygon passes through the mean of its corners and is normal to its area vector. The polygon is
/// divided in its projection onto this plane:
///
/// - as a fan around its first corner, if no triangle of the fan is reversed or flat. This includes all convex polygons
/// without three corners on a line. Flat triangles in the fan are accepted if all corners lie on a line, or if the
/// polygon has more than kMaxPolygonCorners corners.
/// - by ear clipping otherwise, the best-shaped ear first. O(n^2). Flat triangles are avoided: if the corners a, b and
/// c lie on a line, the edge from a to c would belong to three triangles, the flat triangle and one on each side of the
/// edge. A boundary that touches itself is allowed, such as the bridge between an outline and a hole.
///
/// Differences below the rounding error of single precision do not count. Throws PolygonError if the polygon crosses
/// itself, is not planar (kMaxUnevenness), or has too many corners for ear clipping (kMaxPolygonCorners).
/// Preconditions: at least 3 corners; finite coordinates of at most 1e100.
class PolygonDivider {
 public:
  const DividedPolygon& divide(std::span<const Vec3> corners);

 private:
  /// Corner in the plane of the polygon, in units of the polygon's diameter.
  struct Point {
    double x, y;
    std::uint32_t corner;  ///< index in the polygon
  };
  static double doubled_area(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  static double squared_distance(const Point& a, const Point& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
  }
  static bool is_same_position(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

  /// Sets `points_`, `rounding_` and the unevenness. Returns false if all corners are on a line.
  bool project(std::span<const Vec3> corners);
  /// Result of fan(), the test of the fan around the first corner. `good`: the fan covers the polygon once.
  /// `has_flat_triangles`: the fan covers the polygon once, but some of its triangles have no area. `invalid`: the fan
  /// does not cover the polygon once.
  enum class Fan { good, has_flat_triangles, invalid };
  Fan fan() const;
  void drop_repeated_corners();
  void refuse_crossings() const;
  bool turns_once() const;
  void clip_ears();
  /// Returns the shape quality of the ear at remaining corner `i`; 0 if there is no ear.
  double ear_quality(std::size_t i) const;
  /// Returns true if the ear a, b, c cannot be clipped because remaining corner `j` lies in the ear, or on the ear's
  /// new edge from c to a.
  bool blocks(std::size_t j, const Point& a, const Point& b, const Point& c) const;
  /// Returns the remaining corner to clip if rounding leaves no ear: the corner with the flattest triangle if a
  /// triangle is flat, otherwise the corner with the triangle of the largest positive area. Throws PolygonError if no
  /// triangle is flat and no triangle has a positive area.
  std::size_t flattest_corner() const;
  void clip(std::size_t i);
  std::size_t before(std::size_t i) const { return (i == 0 ? points_.size() : i) - 1; }
  std::size_t after(std::size_t i) const { return i + 1 == points_.size() ? 0 : i + 1; }
  double doubled_area_at(std::size_t i) const {
    return doubled_area(points_[before(i)], points_[i], points_[after(i)]);
  }

  std::vector<Point> points_;      ///< remaining corners
  std::vector<double> qualities_;  ///< shape qualities of the ears at the remaining corners; 0 if there is no ear
  double rounding_ = 0.0;          ///< lengths up to this value count as zero, in units of the polygon's diameter
  DividedPolygon divided_;
};

}  // namespace hapbench
