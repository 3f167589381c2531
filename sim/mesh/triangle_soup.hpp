#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// Triangles as files hold them: loose, in any winding, with vertices repeated or unused.
struct TriangleSoup {
  using Triangle = std::array<std::uint32_t, 3>;  ///< indices of its vertices
  std::vector<Vec3> vertices;                     ///< [m]
  std::vector<Triangle> triangles;
};

}  // namespace hapbench
