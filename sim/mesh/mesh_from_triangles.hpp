#pragma once

#include <stdexcept>

#include "sim/mesh/half_edge_mesh.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {

/// What was odd about triangles that make a surface all the same.
struct MeshFindings {
  std::size_t degenerate_triangles = 0;  ///< with two equal corners: left out
  std::size_t rewound_triangles = 0;     ///< wound against most of their part: turned
  std::size_t inside_out_parts = 0;      ///< closed parts whose normals pointed inwards: turned
  /// Middles of the edges with more than two triangles: the surface is cut along them.
  std::vector<Vec3> crowded_edges = {};
  /// Middles of the edges with a triangle on one side only, where the surface is open.
  std::vector<Vec3> open_edges = {};
};

struct CheckedMesh {
  HalfEdgeMesh mesh;
  MeshFindings findings;
};

/// The triangles are no surface with an inside and an outside; the message says why and where.
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The surface the triangles make. Vertices at the same position are one, except that each fan of triangles has its own
/// where several meet in a point; unused ones are left out; the rest keep their order. An edge with more than two
/// triangles joins none of them, so that each fan at its ends has its own vertices there, too. The winding of each
/// connected part is made consistent, with the majority, and outward if the part is closed; a part in the bounding box
/// of a larger one, which may be a cavity, turns with it. Throws MeshError when there are no triangles, one side cannot
/// be told from the other (a Moebius band), a coordinate is not finite, or more than 10,000 triangles meet in a vertex,
/// which would take quadratic time. O(n log n) otherwise. Precondition: indices are valid.
CheckedMesh mesh_from_triangles(const TriangleSoup& soup);

}  // namespace hapbench
