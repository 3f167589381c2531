#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/cylinder.hpp"

/// Random contact sets for which an algorithm may compute a force that is not finite. Most sets are degenerate. All
/// tools are cylinders, because the gradient of the depth in a cylinder is undefined on its axis and on its rims.
namespace hapbench {

/// A tool, surface points in contact with it, and the settings of the rendering.
struct ContactSet {
  Cylinder tool;
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();      ///< [m/s]
  std::vector<SurfacePoint> points;  ///< inside the tool up to rounding; normals are unit vectors or zero
  RenderingConfig rendering;         ///< settings of the rendering; the field `algorithm` is not used
};

/// Largest number of points of a set. If the rendering reduces the contacts, it keeps at most n_ext of these points.
inline constexpr std::size_t kMaxContacts = 200;

/// Returns the contact set with the number `i` in the random sequence of `seed`. StressCounts::first_bad is such a
/// number. Points are random, coincident, on the tool's axis or on its surface. Normals are random, zero, or exactly or
/// nearly equal or opposite. The number of different normals can exceed n_ext. The scale of all lengths is 1e-12 to
/// 1e3 m.
ContactSet stress_set(std::uint64_t seed, std::uint64_t i);

}  // namespace hapbench
