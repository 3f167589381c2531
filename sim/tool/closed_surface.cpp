#include "sim/tool/closed_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "sim/core/parallel.hpp"

namespace hapbench {
namespace {

/// A closed surface that encloses less than this fraction of its bounding cube is flat up to rounding.
constexpr double kFlat = 1e-12;

struct Edge {
  std::uint32_t low, high;  ///< its ends
  int direction;            ///< 1 from low to high
  bool same_place(const Edge& other) const { return low == other.low && high == other.high; }
};

}  // namespace

WeldedSurface welded(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles) {
  WeldedSurface surface;
  std::vector<std::uint32_t> order(vertices.size()), place(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i : order) {
    if (!vertices[i].allFinite())
      throw std::invalid_argument("vertex " + std::to_string(i) + " of the mesh is not finite");
  }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return before(vertices[a], vertices[b]); });
  for (const std::uint32_t i : order) {
    if (surface.vertices.empty() || surface.vertices.back() != vertices[i]) surface.vertices.push_back(vertices[i]);
    place[i] = static_cast<std::uint32_t>(surface.vertices.size() - 1);
  }
  for (const TriangleCorners& t : triangles) {
    if (std::max({t[0], t[1], t[2]}) >= vertices.size()) {
      throw std::invalid_argument("a triangle of the mesh names a vertex that it has not");
    }
    const TriangleCorners corners{place[t[0]], place[t[1]], place[t[2]]};
    const bool degenerate = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
    if (!degenerate) surface.triangles.push_back(corners);
  }
  return surface;
}

ClosedSurface::ClosedSurface(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles) {
  auto [welded_vertices, welded_triangles] = welded(vertices, triangles);
  vertices_ = std::move(welded_vertices);
  triangles_ = std::move(welded_triangles);
  if (triangles_.empty()) throw std::invalid_argument("the mesh has no triangles");
  check_edges();
  measure();
}

void ClosedSurface::check_edges() const {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles_.size());
  for (const TriangleCorners& t : triangles_) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  std::size_t open = 0, against = 0;
  Vec3 where = Vec3::Zero();
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    int sum = 0;
    for (end = i; end < edges.size() && edges[end].same_place(edges[i]); ++end) sum += edges[end].direction;
    if (sum == 0) continue;
    if (open + against == 0) where = 0.5 * (vertices_[edges[i].low] + vertices_[edges[i].high]);
    ++((end - i) % 2 == 1 ? open : against);
  }
  if (open + against == 0) return;
  std::ostringstream message;
  message << "the mesh bounds no solid: " << open << " open edges (a triangle on one side only)";
  if (against > 0) message << ", " << against << " edges whose triangles are wound against each other";
  message << "; the first at [" << where.x() << ", " << where.y() << ", " << where.z() << "] m; close its holes";
  throw std::invalid_argument(message.str());
}

void ClosedSurface::measure() {
  low_ = high_ = vertices_[triangles_.front()[0]];
  for (const TriangleCorners& t : triangles_) {
    for (const Vec3& v : corners(t)) {
      low_ = low_.cwiseMin(v);
      high_ = high_.cwiseMax(v);
    }
  }
  const Vec3 centre = 0.5 * (low_ + high_);
  for (const TriangleCorners& t : triangles_) {
    const auto [a, b, c] = corners(t);
    volume_ += (a - centre).dot((b - centre).cross(c - centre)) / 6.0;
  }
  const double edge = (high_ - low_).maxCoeff();
  std::ostringstream message;
  if (!(std::abs(volume_) > kFlat * edge * edge * edge)) {
    message << "the mesh encloses no volume (" << volume_ << " m^3, " << edge << " m long)";
  } else if (volume_ < 0.0) {
    message << "the mesh is inside out (volume " << volume_
            << " m^3): turn its triangles counter-clockwise from outside";
  } else {
    return;
  }
  throw std::invalid_argument(message.str());
}

namespace {

/// The range of nodes of a row within [low, high].
std::pair<std::size_t, std::size_t> nodes_within(const GridNodes& nodes, int axis, double low, double high) {
  // One more on each side covers the rounding of the division.
  const double first = std::floor((low - nodes.origin[axis]) / nodes.spacing) - 1.0;
  const double last = std::ceil((high - nodes.origin[axis]) / nodes.spacing) + 1.0;
  const auto count = static_cast<double>(nodes.count[static_cast<std::size_t>(axis)]);
  return {static_cast<std::size_t>(std::clamp(first, 0.0, count)),
          static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, count))};
}

}  // namespace

std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes) {
  // The triangles met by each layer of columns.
  std::vector<std::vector<std::uint32_t>> layers(nodes.count[0]);
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) {
    const auto [a, b, c] = surface.corners(surface.triangles()[t]);
    const auto [first, last] = nodes_within(nodes, 0, std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}));
    for (std::size_t i = first; i < last; ++i) layers[i].push_back(t);
  }
  std::vector<std::int8_t> numbers(nodes.size());
  parallel_for(std::size_t{0}, nodes.count[0], [&](std::size_t i) {
    std::vector<std::vector<Crossing>> columns(nodes.count[1]);
    const double x = nodes.coordinate(0, i);
    for (const std::uint32_t t : layers[i]) {
      const std::array<Vec3, 3> corners = surface.corners(surface.triangles()[t]);
      const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
      const auto [first, last] = nodes_within(nodes, 1, low, high);
      for (std::size_t j = first; j < last; ++j) {
        if (const auto met = vertical_crossing(corners, x, nodes.coordinate(1, j))) columns[j].push_back(*met);
      }
    }
    for (std::size_t j = 0; j < nodes.count[1]; ++j) {
      std::sort(columns[j].begin(), columns[j].end(), [](const Crossing& a, const Crossing& b) { return a.z < b.z; });
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
