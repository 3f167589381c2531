#include "sim/tool/closed_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace hapbench {
namespace {

/// A closed surface that encloses less than this share of its bounding cube is flat up to rounding.
constexpr double kFlat = 1e-12;

bool before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

struct Edge {
  std::uint32_t low, high;  ///< its ends
  int direction;            ///< 1 from low to high
  bool same_place(const Edge& other) const { return low == other.low && high == other.high; }
};

}  // namespace

ClosedSurface::ClosedSurface(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles) {
  weld(vertices, triangles);
  if (triangles_.empty()) throw std::invalid_argument("the mesh has no triangles");
  check_edges();
  measure();
}

void ClosedSurface::weld(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles) {
  std::vector<std::uint32_t> order(vertices.size()), place(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i : order) {
    if (!vertices[i].allFinite())
      throw std::invalid_argument("vertex " + std::to_string(i) + " of the mesh is not finite");
  }
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return before(vertices[a], vertices[b]); });
  for (const std::uint32_t i : order) {
    if (vertices_.empty() || vertices_.back() != vertices[i]) vertices_.push_back(vertices[i]);
    place[i] = static_cast<std::uint32_t>(vertices_.size() - 1);
  }
  for (const TriangleCorners& t : triangles) {
    if (std::max({t[0], t[1], t[2]}) >= vertices.size()) {
      throw std::invalid_argument("a triangle of the mesh names a vertex that it has not");
    }
    const TriangleCorners welded{place[t[0]], place[t[1]], place[t[2]]};
    const bool degenerate = welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0];
    if (!degenerate) triangles_.push_back(welded);
  }
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

}  // namespace hapbench
