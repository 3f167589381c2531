#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#ifndef EIGEN_DONT_VECTORIZE
#error "EIGEN_DONT_VECTORIZE is missing, on which layouts depend: link hapbench::sim, which brings it"
#endif

/// Small types that all folders share. SI units (m, s, N, kg, rad) and double precision everywhere; world frame W,
/// right-handed. A planar scene is a 3-D scene whose points, normals and motion have no z component.
namespace hapbench {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// An axis-aligned box in the world frame [m]. Empty when min > max.
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

/// Distance of a point from a box that is not empty [m]; 0 inside.
inline double distance_to(const Box& box, const Vec3& point) noexcept {
  return (point - point.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

/// Whether a run may skip work that cannot change its results. The output must be identical either way; `off` exists to
/// test that. It is therefore no field of a scenario file, although a scenario in memory carries it (RenderingConfig).
enum class Skips {
  on,  ///< compute only what the results depend on
  off  ///< compute everything, by brute force, even if nothing reads it
};

}  // namespace hapbench
