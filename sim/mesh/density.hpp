#pragma once

namespace hapbench {

/// What a density grid stores at its nodes.
enum class Density {
  signed_distance,  ///< minus the signed distance, iso value 0
  binary            ///< 1 inside and 0 outside, iso value 0.5: the "raw density field" of thesis 2.1 taken literally
};

}  // namespace hapbench
