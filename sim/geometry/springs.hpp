#pragma once

#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// Springs attached to the tool's position, all with natural length at the origin (thesis A.2). Spring j has the unit
/// gradient u_j and the penetration depth d_j = <p, u_j>. Bilateral springs push and pull: their depths are signed, or,
/// as thesis 2.3 has it (d >= 0), |<p, u_j>| with the gradient along the displacement. Each pulls the same either way,
/// but a law that averages gradients sees opposite springs as one direction instead of none. Unilateral springs count
/// as contacts only while d_j > 0.
struct SpringSet {
  std::vector<Vec3> gradients;
  bool bilateral = true;
  bool signed_depths = true;  ///< of bilateral springs
};

}  // namespace hapbench
