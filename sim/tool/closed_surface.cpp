#include "sim/tool/closed_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "sim/core/parallel.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

/// Smallest allowed volume, relative to the cube of the bounding box's longest edge. A surface that encloses less is
/// flat up to rounding.
constexpr double kFlat = 1e-12;

/// Returns an index range, as first and one past the last, that contains all nodes within [low, high] along an axis.
std::pair<std::size_t, std::size_t> nodes_within(const GridNodes& nodes, int axis, double low, double high) {
  // One more node on each side covers the rounding of the division.
  const double first = std::floor((low - nodes.origin[axis]) / nodes.spacing) - 1.0;
  const double last = std::ceil((high - nodes.origin[axis]) / nodes.spacing) + 1.0;
  const auto count = static_cast<double>(nodes.count[static_cast<std::size_t>(axis)]);
  return {static_cast<std::size_t>(std::clamp(first, 0.0, count)),
          static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, count))};
}

}  // namespace

TriangleSoup welded(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles) {
  TriangleSoup surface;
  std::vector<std::uint32_t> order(vertices.size()), merged(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite()) refuse("vertex ", i, " of the mesh is not finite");
  }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return before(vertices[a], vertices[b]); });
  // Merge vertices at the same position, which are neighbours in the sorted order.
  for (const std::uint32_t i : order) {
    if (surface.vertices.empty() || surface.vertices.back() != vertices[i]) surface.vertices.push_back(vertices[i]);
    merged[i] = static_cast<std::uint32_t>(surface.vertices.size() - 1);
  }
  // Renumber the corners, and omit degenerate triangles.
  for (const TriangleCorners& t : triangles) {
    if (std::max({t[0], t[1], t[2]}) >= vertices.size())
      refuse("a triangle of the mesh refers to a vertex that does not exist");
    const TriangleCorners corners{merged[t[0]], merged[t[1]], merged[t[2]]};
    const bool degenerate = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    if (!degenerate) surface.triangles.push_back(corners);
  }
  return surface;
}

std::vector<TriangleSide> sides_by_edge(std::span<const TriangleCorners> triangles) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const TriangleSide& a, const TriangleSide& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

bool is_balanced(std::span<const TriangleSide> edge) {
  return 2 * std::ranges::count(edge, true, &TriangleSide::forward) == std::ssize(edge);
}

ClosedSurface::ClosedSurface(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles)
    : surface_(welded(vertices, triangles)) {
  if (surface_.triangles.empty()) refuse("the mesh has no triangles");
  check_edges();
  measure();
}

void ClosedSurface::check_edges() const {
  // Count the open edges and the edges with inconsistent winding; keep the midpoint of the first such edge.
  std::size_t open = 0, against = 0;
  Vec3 where = Vec3::Zero();
  for_each_edge(sides_by_edge(triangles()), [&](std::span<const TriangleSide> edge) {
    if (is_balanced(edge)) return;
    if (open + against == 0) where = 0.5 * (vertices()[edge[0].low] + vertices()[edge[0].high]);
    ++(edge.size() % 2 == 1 ? open : against);
  });
  if (open + against == 0) return;
  const std::string wound =
      against > 0 ? joined(", ", against, " edges whose triangles have inconsistent winding") : "";
  refuse("the mesh bounds no solid: ", open, " boundary edges (edges with only one triangle)", wound,
         "; the first at [", coordinates(where), "] m; close its holes");
}

void ClosedSurface::measure() {
  box_ = box_of(corners(triangles().front()));
  for (const TriangleCorners& t : triangles()) {
    for (const std::uint32_t v : t) box_.add(vertices()[v]);
  }
  // Sum the volumes of the tetrahedra between the triangles and the centre.
  double volume = 0.0;
  const Vec3 centre = 0.5 * (box_.min + box_.max);
  for (const TriangleCorners& t : triangles()) {
    const auto [a, b, c] = corners(t);
    volume += (a - centre).dot((b - centre).cross(c - centre)) / 6.0;
  }
  // Reject flat surfaces and surfaces with inward normals.
  const double edge = box_.size().maxCoeff();
  if (!(std::abs(volume) > kFlat * edge * edge * edge))
    refuse("the mesh encloses no volume (", volume, " m^3, ", edge, " m long)");
  if (volume < 0.0)
    refuse("the mesh is inside out (volume ", volume,
           " m^3): order the corners of its triangles counter-clockwise, seen from outside");
}

/// Returns the crossings of each column of a layer (equal x) with the triangles, from below.
static std::vector<std::vector<Crossing>> crossings_of_layer(const ClosedSurface& surface, const GridNodes& nodes,
                                                             const std::vector<std::uint32_t>& triangles, double x) {
  std::vector<std::vector<Crossing>> columns(nodes.count[1]);
  for (const std::uint32_t t : triangles) {
    const std::array<Vec3, 3> corners = surface.corners(surface.triangles()[t]);
    const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
    const auto [first, last] = nodes_within(nodes, 1, low, high);
    for (std::size_t j = first; j < last; ++j) {
      if (const auto met = vertical_crossing(corners, x, nodes.coordinate(1, j))) columns[j].push_back(*met);
    }
  }
  for (std::vector<Crossing>& column : columns)
    std::sort(column.begin(), column.end(), [](const Crossing& a, const Crossing& b) { return a.z < b.z; });
  return columns;
}

std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes) {
  // Sort the triangles into the layers of columns (equal x) that they touch.
  std::vector<std::vector<std::uint32_t>> layers(nodes.count[0]);
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) {
    const auto [a, b, c] = surface.corners(surface.triangles()[t]);
    const auto [first, last] = nodes_within(nodes, 0, std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}));
    for (std::size_t i = first; i < last; ++i) layers[i].push_back(t);
  }
  std::vector<std::int8_t> numbers(nodes.size());
  // For each layer, intersect its columns with the triangles, then sum the crossings from below.
  parallel_for(std::size_t{0}, nodes.count[0], [&](std::size_t i) {
    const auto columns = crossings_of_layer(surface, nodes, layers[i], nodes.coordinate(0, i));
    for (std::size_t j = 0; j < nodes.count[1]; ++j) {
      auto next = columns[j].cbegin();
      int number = 0;
      for (std::size_t k = 0; k < nodes.count[2]; ++k) {
        for (const double z = nodes.coordinate(2, k); next != columns[j].cend() && next->z <= z; ++next)
          number += next->step;
        numbers[nodes.index(i, j, k)] = static_cast<std::int8_t>(std::clamp(number, -128, 127));
      }
    }
  });
  return numbers;
}

}  // namespace hapbench
