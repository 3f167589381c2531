#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <vector>

#include "sim/geometry/point_shell.hpp"

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

}  // namespace hapbench
