#pragma once

#include "sim/geometry/analytic_shells.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {

/// True interpenetration of a flat-tipped cylinder (ideal_trajectory.hpp says why of no other tool) with the block [m]:
/// the depth below the block's surface of the tool's deepest point, from the exact shapes and not from a shell; 0 when
/// they do not overlap. For a tool that touches the hole and the top face round it; the block's other edges are not
/// looked at.
///
/// Near the hole the depth is min(D, -z), D the signed distance from the hole without its mouth: a convex function,
/// equal to rho - R above the hole's bottom. Along each straight line of the tool's side, going up from the tip, -z
/// falls, so that the deepest point is the line's end in the tip or where D = -z, on the cone of 45 degrees that opens
/// downwards from the rim: both closed forms. (Inside the tip's flat no point is deepest: a horizontal way out of it
/// keeps z, and D does not fall both ways.) Neighbouring lines are at most radius * angle apart and so their deepest
/// points differ by no more; of 64 lines round the tool, the angles about each one that is deeper than its neighbours
/// are searched if they may hold the deepest, to 1e-8 rad, which gives the depth to about 1e-11 m. About 2 us.
/// Precondition: the tool does not point upwards, axis.z <= 0.
double interpenetration(const BlockWithHole& block, const Cylinder& tool, const ToolPose& pose);

}  // namespace hapbench
