#include "sim/mesh/half_edge_mesh.hpp"

#include <OpenMesh/Tools/Subdivider/Uniform/LongestEdgeT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {
namespace {

Vec3 position(const HalfEdgeMesh& mesh, OpenMesh::VertexHandle vertex) {
  const auto& p = mesh.point(vertex);
  return {p[0], p[1], p[2]};
}

/// Unit normal; zero for a face without area.
Vec3 unit_normal(const HalfEdgeMesh& mesh, OpenMesh::FaceHandle face) {
  auto corner = mesh.cfv_begin(face);
  const Vec3 a = position(mesh, *corner++), b = position(mesh, *corner++), c = position(mesh, *corner);
  return triangle_normal(a, b, c);
}

/// Coordinates of a cube, and axis and sign of the normal's largest component.
using Place = std::array<double, 5>;

Vec3 cube_of(const Vec3& position, double spacing) {
  return (position / spacing + Vec3::Constant(0.5)).array().floor();
}

Place place_of(const SurfacePoint& point, double spacing) {
  const Vec3 cube = cube_of(point.position, spacing);
  Eigen::Index axis = 0;
  point.normal.cwiseAbs().maxCoeff(&axis);
  return {cube.x(), cube.y(), cube.z(), static_cast<double>(axis), point.normal[axis] < 0.0 ? -1.0 : 1.0};
}

double distance_from_centre(const SurfacePoint& point, double spacing) {
  return (point.position - spacing * cube_of(point.position, spacing)).norm();
}

using SquaredLengths = std::array<double, 3>;

SquaredLengths squared_lengths(const HalfEdgeMesh& mesh, OpenMesh::FaceHandle face) {
  SquaredLengths lengths;
  auto edge = mesh.cfe_begin(face);
  for (double& length : lengths) length = mesh.calc_edge_sqr_length(*edge++);
  return lengths;
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

void refine(HalfEdgeMesh& mesh, double longest_edge) {
  OpenMesh::Subdivider::Uniform::LongestEdgeT<HalfEdgeMesh, double> subdivider;
  subdivider.set_max_edge_length(longest_edge);
  subdivider(mesh, 1);
}

double refined_face_count(const HalfEdgeMesh& mesh, double longest_edge, double most) {
  const double largest = longest_edge * longest_edge;
  double area = 0.0, count = 0.0;
  for (const auto face : mesh.faces()) area += mesh.calc_face_area(face);
  // The equilateral triangle is the largest.
  const double fewest = area / (std::sqrt(3.0) / 4.0 * largest);
  if (fewest > most) return fewest;
  std::vector<SquaredLengths> open;
  for (const auto face : mesh.faces()) {
    open.push_back(squared_lengths(mesh, face));
    count += 1.0;
    while (!open.empty() && count <= most) {
      auto [a, b, c] = open.back();
      open.pop_back();
      if (b > a) std::swap(a, b);
      if (c > a) std::swap(a, c);
      if (a <= largest) continue;
      // The median to the longest edge cuts the triangle, independently of its neighbours: the longest edge of all is
      // the longest of both its triangles.
      const double median = (2.0 * b + 2.0 * c - a) / 4.0;
      open.push_back({a / 4.0, b, median});
      open.push_back({a / 4.0, c, median});
      count += 1.0;
    }
    if (count > most) break;
  }
  return count;
}

std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double spacing) {
  std::map<Place, std::size_t> nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [entry, is_new] = nearest.try_emplace(place_of(points[i], spacing), i);
    if (!is_new && distance_from_centre(points[i], spacing) < distance_from_centre(points[entry->second], spacing))
      entry->second = i;
  }
  std::vector<std::size_t> kept;
  kept.reserve(nearest.size());
  for (const auto& [place, index] : nearest) kept.push_back(index);
  std::sort(kept.begin(), kept.end());
  std::vector<SurfacePoint> thin;
  thin.reserve(kept.size());
  for (const std::size_t index : kept) thin.push_back(points[index]);
  return thin;
}

}  // namespace hapbench
