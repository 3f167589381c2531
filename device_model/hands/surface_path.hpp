#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/contact/smoothed_surface.hpp"

namespace hapbench {

/// A way over a surface, and the surface's normals on it and two smoothing radii to either side, looked up by arc
/// length. Computed before a run from the shell alone, so that a step reads a table and what it gives does not depend
/// on how a force is rendered.
class SurfacePath {
 public:
  /// Over the surface below (or above) the straight legs between `points`, of which there are at least two [m].
  static SurfacePath over(const SmoothedSurface& surface, std::span<const Vec3> points);
  /// From the place nearest to `start` for `length` [m], always on along the part of `direction` that lies in the
  /// surface. Ends earlier where the surface ends or turns against the direction, to within about 6 degrees.
  static SurfacePath along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction, double length);

  /// Largest distance of the entries [m]: a tenth of the radius over which the surface is smoothed.
  static double spacing(double radius) { return 0.1 * radius; }

  double spacing() const noexcept { return spacing_; }  ///< of the entries [m]
  double length() const noexcept { return spacing_ * static_cast<double>(entries_.size() - 1); }
  /// Place and normal at arc length s [m], held beyond the ends.
  SurfacePoint at(double s) const noexcept;
  /// Unit vector along the path at s, within the surface: from one smoothing radius before to one after, so that it
  /// turns steadily around corners. Any direction within the surface where the path has none.
  Vec3 direction(double s) const noexcept;
  /// The outward normal where x is nearest to the surface, when the path is nearest to x at s: sideways of the path the
  /// surface may be bent, too. Held beyond two smoothing radii.
  Vec3 normal_near(const Vec3& x, double s) const noexcept;

 private:
  /// `places` are in order; the path through them gets entries at equal distances.
  SurfacePath(const SmoothedSurface& surface, std::span<const SurfacePoint> places);

  static constexpr std::size_t kSide = 2;  ///< columns either side of the path, a smoothing radius apart
  using Normals = std::array<Vec3, 2 * kSide + 1>;

  /// Where s lies between two entries.
  struct Position {
    std::size_t before, after;
    double fraction;
  };
  Position position(double s) const noexcept;

  double radius_;
  double spacing_;
  std::vector<SurfacePoint> entries_;  ///< at least one
  std::vector<Normals> normals_;       ///< of each entry, from right to left
};

}  // namespace hapbench
