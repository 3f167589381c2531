#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>

#ifndef EIGEN_DONT_VECTORIZE
#error "EIGEN_DONT_VECTORIZE is missing, on which layouts depend: link hapbench::sim, which brings it"
#endif

/// Small types that all folders share. SI units (m, s, N, kg, rad) and double precision everywhere; world frame W,
/// right-handed. A planar scene is a 3-D scene whose points, normals and motion have no z component.
namespace hapbench {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// The vector divided by its length; `otherwise` if that is zero.
inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) noexcept {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : otherwise;
}

/// An axis-aligned box in the world frame [m]. Empty when min > max.
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();

  /// The box around no points.
  static Box nothing() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity)};
  }
  Vec3 size() const { return max - min; }
  /// Grows until the point is inside.
  void add(const Vec3& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
};

/// The box around points, of which there is at least one.
template <class Points>
Box box_of(const Points& points) {
  Box box{points.front(), points.front()};
  for (const Vec3& point : points) box.add(point);
  return box;
}

/// Distance of a point from a box that is not empty [m]; 0 inside.
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

/// The end of a solid of revolution: a plane, or beyond that plane half a ball of the same radius about the tip centre.
enum class Tip { flat, round };

/// A point of a solid of revolution's profile in the axial half plane [m].
struct ProfilePoint {
  double s;    ///< along the axis from the tip centre, <= 0 towards the shank
  double rho;  ///< distance from the axis, >= 0

  bool operator==(const ProfilePoint&) const = default;
};

/// Whether a run may skip work that cannot change its results. The output must be identical either way; `off` exists to
/// test that. It is therefore no field of a scenario file, although a scenario in memory carries it (RenderingConfig).
enum class Skips {
  on,  ///< compute only what the results depend on
  off  ///< compute everything, by brute force, even if nothing reads it
};

}  // namespace hapbench
