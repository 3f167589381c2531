#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#ifndef EIGEN_DONT_VECTORIZE
#error "EIGEN_DONT_VECTORIZE is missing, on which layouts depend: link hapbench::sim, which brings it"
#endif

/// Small vectors of the engine. SI units (m, s, N, kg, rad) and double precision everywhere; world frame W,
/// right-handed. A planar scene is a 3-D scene whose points, normals and motion have no z component.
namespace hapbench {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace hapbench
