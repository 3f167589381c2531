#pragma once

#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// Springs attached to the tool's position, all with natural length at the origin (thesis A.2). Spring j has the unit
/// gradient u_j and the penetration depth d_j = <p, u_j>. Bilateral springs push and pull, so their depths may be
/// negative; unilateral ones count as contacts only while d_j > 0.
struct SpringSet {
  std::vector<Vec3> gradients;
  bool bilateral = true;
};

}  // namespace hapbench
