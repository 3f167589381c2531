#pragma once

#include <stdexcept>

#include "sim/mesh/half_edge_mesh.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {

/// Repairs and irregularities of triangles that make a surface.
struct MeshFindings {
  std::size_t degenerate_triangles = 0;  ///< with two equal corners; omitted
  std::size_t rewound_triangles = 0;     ///< wound against most of their part; turned
  std::size_t inside_out_parts = 0;      ///< closed parts whose normals pointed inwards; turned
  /// Midpoints of the edges with more than two triangles, along which the surface is cut.
  std::vector<Vec3> crowded_edges = {};
  /// Midpoints of the edges with a triangle on one side only, where the surface is open.
  std::vector<Vec3> open_edges = {};
};

struct CheckedMesh {
  HalfEdgeMesh mesh;
  MeshFindings findings;
};

/// The triangles make no surface with an inside and an outside; the message says why and where.
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes a surface of the triangles. Merges vertices at the same position, except that each of several fans of
/// triangles that meet in a point keeps a vertex of its own; omits unused vertices and keeps the order of the others.
/// An edge with more than two triangles connects none of them, so that each fan at its ends has its own vertices, too.
/// Makes the winding of each connected part consistent with its majority, and outward if the part is closed; a part in
/// the bounding box of a larger one, which may be a cavity, turns with it. Throws MeshError if there are no triangles,
/// the sides cannot be distinguished (a Moebius band), a coordinate is not finite, or more than 10,000 triangles meet
/// in a vertex, which would take quadratic time. O(n log n) otherwise. Precondition: indices are valid.
CheckedMesh mesh_from_triangles(const TriangleSoup& soup);

}  // namespace hapbench
