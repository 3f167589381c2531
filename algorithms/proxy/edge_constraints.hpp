#pragma once

#include "sim/contact/contact_buffer.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Typical distance from a shell point to its neighbours [m]: the median, over some of the points, of the distance to
/// the second nearest one, so it is the spacing of a square lattice and of a line alike. Points at one place, as of a
/// shell that lists a vertex for each of its cells, count as one. 0 for fewer than three points.
/// O(size) with about a hundred distances a point; call it in preparation.
double typical_spacing(const PointShell& shell);

/// Keeps the tool's edges from sinking in between the points of a shell. The surface is taken to be flat about each
/// point, as far as the next ones: where the tool's foremost place towards the surface, v_i = argmin <q, n_i> over the
/// tool, lies on that patch, it must stay above it:
///
///     <n_i, v_i + x - x_i> >= 0, appended as contact with depth <n_i, x_i - v_i> and gradient -n_i.
///
/// A drill's edge on a wall touches points with both of its faces, and between two rows of points 0.1 mm apart it finds
/// up to 0.05 mm of room; a patch leaves none. Patches apply up to `margin` away, and to depths up to a tenth of the
/// spacing: the tool never gets deeper, so a patch that lies further out faces something else (the other side of a
/// rim). Call after ToolShape::surface_constraints. `places` is scratch memory for a place of each contact, padded.
/// Preconditions: room for as many contacts again, and as many places. O(n).
void add_edge_constraints(const ToolShape& tool, const ToolPose& pose, double spacing, double margin,
                          const PlaceArrays& places, ContactBuffer& contacts) noexcept;

}  // namespace hapbench
