#pragma once

#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {

/// The vertices that marching_cubes finds, without those that have no normal, as a shell in the order of its grid
/// (in_grid_order). O(vertices); some 92 bytes a point are in use at the end, 48 of them the shell's. Works on all
/// threads that oneTBB gives; the result does not depend on their number.
PointShell surface_shell(const DensityField& field);

}  // namespace hapbench
