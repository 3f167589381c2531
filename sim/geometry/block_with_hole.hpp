#pragma once

#include <functional>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// The validation object of thesis 3.2: a cuboid centred at x = y = 0 with its top face in z = 0, and a round blind
/// hole down its middle.
struct BlockWithHole {
  Vec3 size = {0.015, 0.015, 0.01};  ///< [m]
  double hole_diameter = 0.002;      ///< [m]
  double hole_depth = 0.005;         ///< [m]
};

/// Exact signed distance to the block's surface [m], negative inside the material.
double signed_distance(const BlockWithHole& block, const Vec3& point);

}  // namespace hapbench
