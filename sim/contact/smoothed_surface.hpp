#pragma once

#include "sim/contact/grid_index.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// A point shell as the smooth surface that a finger takes it for: place and normal are averages of the shell's points
/// within a radius, so that they change steadily from point to point.
///
/// Where x is a place near the surface, its neighbours p_i are the points with |p_i - x| < R whose normals lie within a
/// right angle of that of the shell point nearest to the place asked about, so that the far side of a thin wall does
/// not count. With weights w_i = (1 - |p_i - x|^2 / R^2)^2, normal n = sum w_i n_i, normalised, and centre
/// c = sum w_i p_i / sum w_i, the surface near x is the plane through c with the normal n (a moving least-squares
/// surface: Levin 1998; Alexa and Adamson 2004).
class SmoothedSurface {
 public:
  /// `radius` R > 0 [m]. The shell must have a point and outlive this. O(points).
  SmoothedSurface(const PointShell& shell, double radius);

  double radius() const { return radius_; }
  /// The place of the surface below or above `at` and the outward normal there: starts at the nearest shell point and
  /// goes to the foot of the perpendicular from `at` to the plane near the place before, three times. A place that has
  /// no neighbours, as further than R beyond an edge, is not gone to. Costs a look at all points within about `at`'s
  /// distance from the shell, and three at those within R.
  SurfacePoint nearest(const Vec3& at) const;

 private:
  std::size_t nearest_point(const Vec3& at) const;

  const PointShell& shell_;
  GridIndex grid_;
  double radius_;
};

}  // namespace hapbench
