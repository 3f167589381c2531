#pragma once

#include "sim/contact/contact_buffer.hpp"
#include "sim/tool/tool.hpp"

namespace hapbench {

/// What keeps the tool out of points near it: for each contact the signed distance g_i [m] of the point to the tool's
/// surface, negative inside, as depth d_i = -g_i, and the tool's outward normal at the nearest place of its surface as
/// gradient m_i. Pads.
///
/// The tool is convex, so its signed distance is a convex function of the point and m_i one of its subgradients.
/// Moved by x, the tool is at least g_i - <m_i, x> away from the point, hence
///
///     d_i + <m_i, x> <= 0   =>   the point is not inside the moved tool,
///
/// for moves of any length. Where the nearest place is not unique (on the axis, between side and tip), any of the
/// nearest ones has that property; side before tip before bottom.
///
/// A flat tip that slides along a face would bump into the points ahead: they lie in its plane, and the nearest place
/// of the tool is its edge. A point beyond (or within `slack` of) both planes of an edge is kept out by either, so when
/// the wanted move violates the nearest one, the plane that is flush with the surface takes its place, if one is. O(n),
/// eight points at a time.
void surface_constraints(const Tool& tool, const ToolPose& pose, const Vec3& wanted, double slack,
                         ContactBuffer& contacts) noexcept;

}  // namespace hapbench
