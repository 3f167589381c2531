#pragma once

#include "sim/core/simd.hpp"
#include "sim/tool/tool.hpp"

namespace hapbench {

/// Eight points in the tool's axial coordinates: x is relative to the tip centre, s its component along the axis,
/// rho = x - s * axis the radial vector. Search and depth models share this arithmetic, so that a point that counts as
/// colliding never gets a negative depth. For source files only (see simd.hpp).
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

/// Which of eight points lie in the tool or on its surface. `radius2` is the largest square whose root is at most the
/// tool's radius (largest_square_within).
class ToolTest {
 public:
  ToolTest(const Tool& tool, double radius2)
      : bottom_(-tool.length), radius2_(radius2), zero_(0.0), round_(tool.tip == Tip::round) {}

  simd::Mask operator()(const AxialPack& q) const {
    const simd::Mask in_cylinder = q.s <= zero_ && q.s >= bottom_ && q.rho2 <= radius2_;
    return round_ ? in_cylinder || (q.s > zero_ && q.distance2() <= radius2_) : in_cylinder;
  }

 private:
  simd::Pack bottom_, radius2_, zero_;
  bool round_;
};

}  // namespace hapbench
