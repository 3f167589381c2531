#pragma once

#include <span>
#include <vector>

#include "sim/contact/smoothed_surface.hpp"

namespace hapbench {

/// A way over a surface with the surface's normals along it, looked up by arc length. Computed before a run from the
/// shell alone, so that a step reads a table and what it gives does not depend on how a force is rendered.
class SurfacePath {
 public:
  /// Over the surface below (or above) the straight legs between `points`, of which there are at least two [m].
  static SurfacePath over(const SmoothedSurface& surface, std::span<const Vec3> points);
  /// From the place nearest to `start` for `length` [m], always on along the part of `direction` that lies in the
  /// surface. Ends earlier where the surface ends or turns against the direction, to within about 6 degrees.
  static SurfacePath along(const SmoothedSurface& surface, const Vec3& start, const Vec3& direction, double length);

  /// Distance of the entries [m]: a tenth of the radius over which the surface is smoothed.
  static double spacing(double radius) { return 0.1 * radius; }

  double length() const noexcept { return spacing_ * static_cast<double>(entries_.size() - 1); }
  /// Place and normal at arc length s [m], held beyond the ends.
  SurfacePoint at(double s) const noexcept;
  /// Unit vector along the path at s, within the surface: from one smoothing radius before to one after, so that it
  /// turns steadily around corners. Any direction within the surface where the path has none.
  Vec3 direction(double s) const noexcept;

 private:
  /// `places` are in order; the path through them gets an entry every spacing(radius).
  SurfacePath(std::span<const SurfacePoint> places, double radius);

  double radius_;
  double spacing_;
  std::vector<SurfacePoint> entries_;  ///< at least one
};

}  // namespace hapbench
