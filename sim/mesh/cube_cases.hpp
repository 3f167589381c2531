#pragma once

#include <array>
#include <vector>

namespace hapbench {

/// The triangles of marching cubes, computed instead of copied from a table. Corner c of a cell has the coordinates of
/// its bits (bit 0: x, bit 1: y, bit 2: z); edge 3 c + axis starts at corner c, whose bit `axis` is 0, and runs along
/// that axis.
using CubeTriangle = std::array<int, 3>;  ///< edges, counter-clockwise from outside

/// The triangles of the case whose bit c is set when corner c is inside. Neighbouring cells agree about their common
/// face for all cases.
const std::vector<CubeTriangle>& cube_triangles(unsigned inside);

}  // namespace hapbench
