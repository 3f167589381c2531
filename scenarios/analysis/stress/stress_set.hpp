#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/cylinder.hpp"

/// Random contact situations, most of them degenerate, in which a force may stop being finite. All tools are cylinders:
/// directions are lost on their axis, side and rims.
namespace hapbench {

/// A tool among points that it touches, and how they are rendered.
struct ContactSet {
  Cylinder tool;
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();      ///< [m/s]
  std::vector<SurfacePoint> points;  ///< in the tool but for rounding; normals are unit vectors or zero
  RenderingConfig rendering;         ///< all but the algorithm
};

/// Most points of a set; the reduction of some keeps fewer (n_ext).
inline constexpr std::size_t kMostContacts = 200;

/// Returns set number `i` of a seed; StressCounts::first_bad is such a number. Points lie on the axis, on the surface
/// or coincide; normals are zero, equal, opposite, nearly so, or more different than n_ext; scenes measure 1e-12 to 1e3
/// m.
ContactSet stress_set(std::uint64_t seed, std::uint64_t i);

}  // namespace hapbench
