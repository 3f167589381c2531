#pragma once

#include "sim/geometry/block_with_hole.hpp"
#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {

/// The block as a density field, ready for marching cubes; spacing of its grid [m], > 0.
DensityField density_field(const BlockWithHole& block, double spacing, Density density);

}  // namespace hapbench
