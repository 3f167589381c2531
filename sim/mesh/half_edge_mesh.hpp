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

/// The mesh's vertices with outward normals: the normalised, unweighted mean of the unit normals of the adjacent faces
/// (thesis C.1). A vertex without a face of positive area has no normal and is left out. Order: that of the vertices.
std::vector<SurfacePoint> vertices_with_normals(const HalfEdgeMesh& mesh);

}  // namespace hapbench
