#include "sim/tool/triangle_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace hapbench {
namespace {

constexpr std::uint32_t kLeaf = 4;
/// Halving 2^32 triangles takes 32 levels, and a search keeps one box a level.
constexpr std::size_t kStack = 64;
constexpr double kNever = std::numeric_limits<double>::infinity();

double squared_distance_to_segment(const Vec3& a, const Vec3& ab, const Vec3& point) {
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((point - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (point - a - t * ab).squaredNorm();
}

}  // namespace

TriangleTree::TriangleTree(const ClosedSurface& surface) {
  triangles_.reserve(surface.triangles().size());
  for (const TriangleCorners& t : surface.triangles()) {
    const auto [a, b, c] = surface.corners(t);
    triangles_.push_back({a, b, c});
  }
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, static_cast<std::uint32_t>(triangles_.size())});
  // Children are appended, so this reaches them all.
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(node);
}

/// Halves the triangles of a node across their longest extent, unless they are few.
void TriangleTree::split(std::size_t node) {
  const auto [first, count] = std::pair(nodes_[node].first, nodes_[node].count);
  const auto begin = triangles_.begin() + first, end = begin + count;
  Vec3 low = begin->low(), high = begin->high();
  std::for_each(begin, end, [&](const Corners& t) {
    low = low.cwiseMin(t.low());
    high = high.cwiseMax(t.high());
  });
  nodes_[node].low = low;
  nodes_[node].high = high;
  if (count <= kLeaf) return;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = [axis](const Corners& t) { return t.a[axis] + t.b[axis] + t.c[axis]; };
  std::nth_element(begin, begin + count / 2, end,
                   [&](const Corners& a, const Corners& b) { return middle(a) < middle(b); });
  nodes_[node].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].count = 0;
  nodes_.push_back({low, high, first, count / 2});
  nodes_.push_back({low, high, first + count / 2, count - count / 2});
}

double TriangleTree::squared_distance(const Node& node, const Vec3& point) noexcept {
  return (node.low - point).cwiseMax(point - node.high).cwiseMax(0.0).squaredNorm();
}

/// Over the inside of the triangle the foot of the perpendicular is nearest, elsewhere one of the edges.
double TriangleTree::squared_distance(const Corners& t, const Vec3& point) noexcept {
  const Vec3 ab = t.b - t.a, bc = t.c - t.b, ca = t.a - t.c, p = point - t.a;
  const Vec3 normal = ab.cross(-ca);
  const bool within = ab.cross(p).dot(normal) >= 0.0 && bc.cross(point - t.b).dot(normal) >= 0.0 &&
                      ca.cross(point - t.c).dot(normal) >= 0.0;
  if (const double area2 = normal.squaredNorm(); within && area2 > 0.0) {
    const double height = p.dot(normal);
    return height * height / area2;
  }
  return std::min({squared_distance_to_segment(t.a, ab, point), squared_distance_to_segment(t.b, bc, point),
                   squared_distance_to_segment(t.c, ca, point)});
}

double TriangleTree::squared_distance(const Vec3& point, double bound2) const noexcept {
  struct Waiting {
    double distance2;
    std::uint32_t node;
  };
  std::array<Waiting, kStack> stack;
  std::size_t size = 0;
  double best = bound2;
  stack[size++] = {squared_distance(nodes_[0], point), 0};
  while (size > 0) {
    const Waiting next = stack[--size];
    if (next.distance2 > best) continue;
    const Node& node = nodes_[next.node];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      best = std::min(best, squared_distance(triangles_[i], point));
    }
    if (node.count > 0) continue;
    Waiting near{squared_distance(nodes_[node.first], point), node.first};
    Waiting far{squared_distance(nodes_[node.first + 1], point), node.first + 1};
    if (far.distance2 < near.distance2) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
  return best;
}

double TriangleTree::first_hit(const Vec3& origin, const Vec3& direction, double from) const noexcept {
  std::array<std::uint32_t, kStack> stack;
  std::size_t size = 0;
  double best = kNever;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    double enter = from, leave = best;
    for (int k = 0; k < 3; ++k) {
      // A ray along a face of the box divides 0 by 0; the comparisons below then leave the interval as it is.
      const double a = (node.low[k] - origin[k]) / direction[k], b = (node.high[k] - origin[k]) / direction[k];
      if (std::min(a, b) > enter) enter = std::min(a, b);
      if (std::max(a, b) < leave) leave = std::max(a, b);
    }
    if (enter > leave) continue;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Corners& t = triangles_[i];
      const Vec3 ab = t.b - t.a, ac = t.c - t.a, normal = ab.cross(ac), to = t.a - origin;
      const double slope = direction.dot(normal);
      if (slope == 0.0) continue;
      const Vec3 across = direction.cross(to);
      const double u = -across.dot(ac) / slope, v = across.dot(ab) / slope, distance = to.dot(normal) / slope;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > from) best = std::min(best, distance);
    }
    if (node.count > 0) continue;
    stack[size++] = node.first + 1;
    stack[size++] = node.first;
  }
  return best;
}

}  // namespace hapbench
