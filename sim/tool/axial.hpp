#pragma once

#include <limits>

#include "sim/core/simd.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// Relative to the largest radius: nearer to the axis than this, the direction away from it is rounding.
inline constexpr double kOnAxis = 1e-12;
/// The way out of a tool along a ray that never leaves it [m].
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Eight points in the tool's axial coordinates: x is relative to the tip centre, s its component along the axis,
/// rho = x - s * axis the radial vector. All that a solid of revolution computes of points starts from these, so that a
/// point that counts as colliding never gets a negative depth. For source files only (see simd.hpp).
struct AxialPack {
  simd::Pack x, y, z;
  simd::Pack s;
  simd::Pack rho_x, rho_y, rho_z;
  simd::Pack rho2;  ///< |rho|^2

  AxialPack(const ToolPose& pose, const double* px, const double* py, const double* pz)
      : x(simd::load(px) - simd::Pack(pose.position.x())),
        y(simd::load(py) - simd::Pack(pose.position.y())),
        z(simd::load(pz) - simd::Pack(pose.position.z())) {
    const simd::Pack ax(pose.axis.x()), ay(pose.axis.y()), az(pose.axis.z());
    s = x * ax + y * ay + z * az;
    rho_x = x - s * ax;
    rho_y = y - s * ay;
    rho_z = z - s * az;
    rho2 = rho_x * rho_x + rho_y * rho_y + rho_z * rho_z;
  }

  simd::Pack distance2() const { return x * x + y * y + z * z; }
};

}  // namespace hapbench
