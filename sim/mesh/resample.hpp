#pragma once

#include <vector>

#include "sim/mesh/half_edge_mesh.hpp"

namespace hapbench {

/// Splits the longest edges in two until none is longer than `longest_edge` [m], > 0. The surface stays the same.
void refine(HalfEdgeMesh& mesh, double longest_edge);

/// Number of faces `refine` would leave, without making them. Beyond `most` it is some number above that, found soon,
/// because absurd numbers are to be refused.
double refined_face_count(const HalfEdgeMesh& mesh, double longest_edge, double most);

/// Thins the points to one in each cube between half-integer multiples of `spacing` [m] and each main direction of the
/// normal (of six, so that neither side of a thin wall is lost): the one nearest to the cube's centre, the first of
/// equals. Order is kept. O(n log n).
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double spacing);

}  // namespace hapbench
