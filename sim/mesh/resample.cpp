#include "sim/mesh/resample.hpp"

#include <OpenMesh/Tools/Subdivider/Uniform/LongestEdgeT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace hapbench {
namespace {

/// Cube, and axis and sign of the normal's largest component.
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

void refine(HalfEdgeMesh& mesh, double longest_edge) {
  OpenMesh::Subdivider::Uniform::LongestEdgeT<HalfEdgeMesh, double> subdivider;
  subdivider.set_max_edge_length(longest_edge);
  subdivider(mesh, 1);
}

double refined_face_count(const HalfEdgeMesh& mesh, double longest_edge, double most) {
  const double largest = longest_edge * longest_edge;
  double area = 0.0, count = 0.0;
  for (const auto face : mesh.faces()) area += mesh.calc_face_area(face);
  // No triangle is larger than the equilateral one.
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
      // The median to the longest edge cuts the triangle, and every triangle is cut whatever its neighbours do: an edge
      // that is the longest of all is the longest of both its triangles.
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
