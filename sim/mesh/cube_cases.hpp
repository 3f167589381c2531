#pragma once

#include <array>
#include <vector>

namespace hapbench {

/// A triangle of marching cubes, derived instead of copied from a table. The bits of a cell's corner c are its
/// coordinates (bit 0: x, bit 1: y, bit 2: z); edge 3 c + axis starts at corner c, whose bit `axis` is 0, and runs
/// along that axis.
using CubeTriangle = std::array<int, 3>;  ///< edges, counter-clockwise from outside

/// The triangles of the case in which bit c of `inside` is set if corner c is inside. Neighbouring cells agree about
/// their common face in all cases.
const std::vector<CubeTriangle>& cube_triangles(unsigned inside);

}  // namespace hapbench
