#include "sim/mesh/half_edge_mesh.hpp"

#include "sim/mesh/triangle_normal.hpp"

namespace hapbench {
namespace {

Vec3 position(const HalfEdgeMesh& mesh, OpenMesh::VertexHandle vertex) {
  const auto& p = mesh.point(vertex);
  return {p[0], p[1], p[2]};
}

/// Unit normal, zero for a face without area.
Vec3 unit_normal(const HalfEdgeMesh& mesh, OpenMesh::FaceHandle face) {
  auto corner = mesh.cfv_begin(face);
  const Vec3 a = position(mesh, *corner++), b = position(mesh, *corner++), c = position(mesh, *corner);
  return triangle_normal(a, b, c);
}

}  // namespace

std::vector<SurfacePoint> all_vertices(const HalfEdgeMesh& mesh) {
  std::vector<Vec3> face_normals;
  face_normals.reserve(mesh.n_faces());
  for (const auto face : mesh.faces()) face_normals.push_back(unit_normal(mesh, face));

  std::vector<SurfacePoint> points;
  points.reserve(mesh.n_vertices());
  for (const auto vertex : mesh.vertices()) {
    Vec3 sum = Vec3::Zero();
    for (auto face = mesh.cvf_iter(vertex); face.is_valid(); ++face)
      sum += face_normals[static_cast<std::size_t>(face->idx())];
    const double length = sum.norm();
    points.push_back({position(mesh, vertex), length > 0.0 ? Vec3(sum / length) : Vec3::Zero()});
  }
  return points;
}

std::vector<SurfacePoint> vertices_with_normals(const HalfEdgeMesh& mesh) {
  std::vector<SurfacePoint> points = all_vertices(mesh);
  std::erase_if(points, [](const SurfacePoint& point) { return point.normal.isZero(0.0); });
  return points;
}

}  // namespace hapbench
