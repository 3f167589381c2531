#include "sim/mesh/cube_cases.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {
namespace {

constexpr int kEdgeNumbers = 24;  ///< values of 3 c + axis, of which 12 are edges

int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  return 3 * std::min(a, b) + axis;
}

/// The corners of a face, counter-clockwise seen from outside.
std::array<int, 4> face_corners(int axis, int side) {
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  return side == 1 ? std::array{base, base | u, base | u | v, base | v}
                   : std::array{base, base | v, base | u | v, base | u};
}

/// True if both edges lie on one face of the cell: a diagonal between them would lie in that face and might cross the
/// neighbour's.
bool share_a_face(int first, int second) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = [axis](int edge) { return edge % 3 == axis ? -1 : (edge / 3 >> axis) & 1; };
    if (side(first) >= 0 && side(first) == side(second)) return true;
  }
  return false;
}

/// Cuts ears off the polygon with diagonals through the inside of the cell; returns false if that is impossible.
bool triangulate(const std::vector<int>& polygon, std::vector<CubeTriangle>& triangles) {
  const std::size_t n = polygon.size();
  if (n == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return true;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const int before = polygon[(i + n - 1) % n], after = polygon[(i + 1) % n];
    if (share_a_face(before, after)) continue;
    std::vector<int> rest = polygon;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    const std::size_t kept = triangles.size();
    triangles.push_back({before, polygon[i], after});
    if (triangulate(rest, triangles)) return true;
    triangles.resize(kept);
  }
  return false;
}

/// Derives the triangles of a case. On each face, a segment cuts off each run of inside corners: it leads from the edge
/// where a walk around the face enters the run to the edge where it leaves the run. Every crossed edge is entered on
/// one of its two faces and left on the other, so the segments form closed polygons.
std::vector<CubeTriangle> derive(unsigned inside) {
  const auto is_inside = [inside](int corner) { return (inside >> corner & 1u) != 0; };
  std::array<int, kEdgeNumbers> next{};
  next.fill(-1);
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> c = face_corners(face / 2, face % 2);
    for (std::size_t i = 0; i < 4; ++i) {
      if (is_inside(c[i]) || !is_inside(c[(i + 1) % 4])) continue;
      std::size_t last = i + 1;
      while (is_inside(c[(last + 1) % 4])) ++last;
      next[static_cast<std::size_t>(edge_between(c[i], c[(i + 1) % 4]))] = edge_between(c[last % 4], c[(last + 1) % 4]);
    }
  }
  std::vector<CubeTriangle> triangles;
  for (std::size_t start = 0; start < next.size(); ++start) {
    std::vector<int> polygon;
    for (int edge = static_cast<int>(start); next[static_cast<std::size_t>(edge)] >= 0;) {
      polygon.push_back(edge);
      edge = std::exchange(next[static_cast<std::size_t>(edge)], -1);
    }
    if (polygon.empty() || triangulate(polygon, triangles)) continue;
    // Only a polygon that crosses one face twice has no diagonals through the inside.
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
  }
  return triangles;
}

}  // namespace

const std::vector<CubeTriangle>& cube_triangles(unsigned inside) {
  static const auto cases = [] {
    std::array<std::vector<CubeTriangle>, 256> all;
    for (unsigned i = 0; i < all.size(); ++i) all[i] = derive(i);
    return all;
  }();
  return cases[inside];
}

}  // namespace hapbench
