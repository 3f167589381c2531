#pragma once

#include "sim/geometry/block_with_hole.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {

/// True interpenetration of a flat-tipped cylinder (ideal_trajectory.hpp says why of no other tool) with the block [m]:
/// the depth below the block's surface of the tool's deepest point, from the exact shapes and not from a shell; 0 when
/// they do not overlap. For a tool that touches the hole and the top face round it; the block's other edges are not
/// looked at.
///
/// In the material near the hole the depth is min(rho - R, -z) above the hole's bottom, and convex below it. A convex
/// function is largest on the tip's edge; the minimum of the two may also be largest where they are equal, on the cone
/// of 45 degrees that opens downwards from the rim. Both curves are searched for every local maximum, to 1e-8 rad,
/// which gives the depth to about 1e-11 m. About 10 us.
double interpenetration(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose);

}  // namespace hapbench
