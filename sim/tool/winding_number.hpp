#pragma once

#include <cstdint>
#include <vector>

#include "sim/tool/closed_surface.hpp"
#include "sim/tool/grid_nodes.hpp"

namespace hapbench {

/// How often the surface winds around each node: 0 outside, 1 inside a sound solid, concave or not; anything else where
/// parts overlap or are inside out.
///
/// The sum of the signed crossings of the ray from below along z. The winding number of a closed surface is that sum
/// for any ray, so one pass over each column of nodes answers for all of them, and needs no normals of edges and
/// vertices. Whether a ray meets a triangle is decided by the signs of three edges, computed alike for both triangles
/// of an edge; a ray through an edge counts as one a little beside it. Columns are shared out among oneTBB's threads;
/// the result does not depend on their number. Cost: triangles times the columns they cover, and the nodes.
std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes);

}  // namespace hapbench
