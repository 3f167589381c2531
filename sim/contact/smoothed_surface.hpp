#pragma once

#include "sim/contact/grid_index.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// A point shell as a smooth surface: place and normal are averages over the shell's points within a radius R, so that
/// they change steadily from point to point.
///
/// The neighbours p_i of a place x are the points with |p_i - x| < R whose normals are within a right angle of the
/// normal of the shell point nearest to the queried place; this excludes the far side of a thin wall. With the weights
/// w_i = (1 - |p_i - x|^2 / R^2)^2, the normalised normal n = sum w_i n_i and the centre c = sum w_i p_i / sum w_i, the
/// surface near x is the plane through c with the normal n (a moving least-squares surface: Levin 1998; Alexa and
/// Adamson 2004).
class SmoothedSurface {
 public:
  /// `radius` R > 0 [m]. The shell must have a point and outlive this object. O(points).
  SmoothedSurface(const PointShell& shell, double radius);

  double radius() const { return radius_; }
  /// Returns the place of the surface below or above `at` and the outward normal there. Starts at the nearest shell
  /// point and projects `at` three times onto the plane near the last place; stops before a place without neighbours,
  /// such as one further than R beyond an edge. Visits all points within about `at`'s distance from the shell once and
  /// those within R three times.
  SurfacePoint nearest(const Vec3& at) const;

 private:
  std::size_t nearest_point(const Vec3& at) const;

  const PointShell& shell_;
  GridIndex grid_;
  double radius_;
};

}  // namespace hapbench
