#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/half_edge_mesh.hpp"

namespace hapbench {

struct HalfEdgeMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

/// A triangle mesh that knows its neighbours; double precision, coordinates in m, faces counter-clockwise from outside.
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeMeshTraits>;

/// All vertices of the mesh in order, with outward normals: the normalised, unweighted mean of the unit normals of the
/// adjacent faces (thesis C.1). The normal is zero where no adjacent face has a positive area.
std::vector<SurfacePoint> all_vertices(const HalfEdgeMesh& mesh);
/// The same without the vertices that have no normal.
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

}  // namespace hapbench
