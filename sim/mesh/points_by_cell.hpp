#pragma once

#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {

/// The vertices of a surface as the thesis keeps them (2.1, C.2): listed once for each cell that has them on an edge,
/// four times on average, so that each point belongs to one cell. Cells come in the order that the contact search
/// likes, the points of a cell in that of its edges. A vertex without a normal is left out. `spacing` is that of the
/// grid [m]. O(vertices). Precondition: the surface has its cells.
ShellPoints points_by_cell(const IsoSurface& surface, double spacing);

}  // namespace hapbench
