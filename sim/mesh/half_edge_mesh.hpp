#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <stdexcept>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

struct HalfEdgeMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

/// A triangle mesh that knows its neighbours; double precision, coordinates in m, faces counter-clockwise from outside.
struct HalfEdgeMesh : OpenMesh::TriMesh_ArrayKernelT<HalfEdgeMeshTraits> {
  /// As the base does, which is compiled with checks of every handle and takes twice as long.
  void split(OpenMesh::EdgeHandle edge, OpenMesh::VertexHandle middle);
};

/// The vertices of the mesh in order, with outward normals: the normalised, unweighted mean of the unit normals of the
/// adjacent faces (thesis C.1). Omits vertices without an adjacent face that has a positive area.
std::vector<SurfacePoint> vertices_with_normals(const HalfEdgeMesh& mesh);

/// Splits the longest edges in two until none is longer than `longest_edge` [m], > 0. Does not change the surface.
void refine(HalfEdgeMesh& mesh, double longest_edge);

/// Number of faces that `refine` would make. If it exceeds `most`, returns some number above `most` early, so that
/// absurd numbers can be refused.
double refined_face_count(const HalfEdgeMesh& mesh, double longest_edge, double most);

/// Keeps one point for each cube between half-integer multiples of `spacing` [m] and each of six main directions of the
/// normal, so that both sides of a thin wall remain: the point nearest to the cube's centre, or the first of equals.
/// Keeps the order. O(n log n).
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double spacing);

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
/// An edge with more than two triangles connects none of them, so that each fan at its ends also has its own vertices.
/// Makes the winding of each connected part consistent with its majority, and outward if the part is closed; a part in
/// the bounding box of a larger one, which may be a cavity, turns with it. Throws MeshError if there are no triangles,
/// the sides cannot be distinguished (a Moebius band), a coordinate is not finite, or more than 10,000 triangles meet
/// in a vertex, which would take quadratic time. O(n log n) otherwise. Precondition: indices are valid.
CheckedMesh mesh_from_triangles(const TriangleSoup& soup);

}  // namespace hapbench
