#include "sim/tool/triangle_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr std::uint32_t kLeaf = 4;  ///< maximum number of triangles
/// Halving 2^32 triangles takes 32 levels, and a search keeps one box per level.
constexpr std::size_t kStack = 64;
constexpr double kFarthest = std::numeric_limits<double>::infinity();

using simd::Mask, simd::Pack;

/// Eight points or vectors.
struct Packs {
  Pack x, y, z;
  Packs operator-(const Vec3& from) const { return {x - Pack(from.x()), y - Pack(from.y()), z - Pack(from.z())}; }
  Pack dot(const Vec3& v) const { return x * Pack(v.x()) + y * Pack(v.y()) + z * Pack(v.z()); }
};

/// `from`: the points relative to an end of the side; `along`: their products with the side.
Pack squared_distance_to_side(const Packs& from, const Vec3& side, const Pack& along, double per_length2) {
  const Pack t = simd::min(simd::max(along * Pack(per_length2), Pack(0.0)), Pack(1.0));
  const Pack dx = from.x - t * Pack(side.x()), dy = from.y - t * Pack(side.y()), dz = from.z - t * Pack(side.z());
  return dx * dx + dy * dy + dz * dz;
}

Pack squared_distance_to_box(const Vec3& low, const Vec3& high, const Packs& points) {
  const Packs below = points - low, above = points - high;
  const auto beyond = [](const Pack& from_low, const Pack& from_high) {
    return simd::max(simd::max(-from_low, from_high), Pack(0.0));
  };
  const Pack dx = beyond(below.x, above.x), dy = beyond(below.y, above.y), dz = beyond(below.z, above.z);
  return dx * dx + dy * dy + dz * dz;
}

}  // namespace

TriangleTree::Triangle::Triangle(const Vec3& a_, const Vec3& b, const Vec3& c)
    : a(a_),
      ab(b - a_),
      ac(c - a_),
      normal(ab.cross(ac).stableNormalized()),
      ab2(ab.squaredNorm()),
      abac(ab.dot(ac)),
      ac2(ac.squaredNorm()),
      per_ab2(1.0 / ab2),
      per_bc2(1.0 / (c - b).squaredNorm()),
      per_ac2(1.0 / ac2) {
  const double area2 = ab2 * ac2 - abac * abac;
  per_area = area2 > 0.0 ? 1.0 / area2 : std::numeric_limits<double>::quiet_NaN();
}

TriangleTree::TriangleTree(const ClosedSurface& surface) {
  triangles_.reserve(surface.triangles().size());
  for (const TriangleCorners& t : surface.triangles()) {
    const auto [a, b, c] = surface.corners(t);
    triangles_.emplace_back(a, b, c);
  }
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, static_cast<std::uint32_t>(triangles_.size())});
  // Visits appended children, too.
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(node);
}

/// Halves the triangles of a node across their longest extent, unless a leaf holds them.
void TriangleTree::split(std::size_t node) {
  const auto [first, count] = std::pair(nodes_[node].first, nodes_[node].count);
  const auto begin = triangles_.begin() + first, end = begin + count;
  Vec3 low = begin->low(), high = begin->high();
  std::for_each(begin, end, [&](const Triangle& t) {
    low = low.cwiseMin(t.low());
    high = high.cwiseMax(t.high());
  });
  nodes_[node].low = low;
  nodes_[node].high = high;
  if (count <= kLeaf) return;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = [axis](const Triangle& t) { return 3.0 * t.a[axis] + t.ab[axis] + t.ac[axis]; };
  std::nth_element(begin, begin + count / 2, end,
                   [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
  nodes_[node].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].count = 0;
  nodes_.push_back({low, high, first, count / 2});
  nodes_.push_back({low, high, first + count / 2, count - count / 2});
}

void TriangleTree::lower_to_squared_distances(const double* x, const double* y, const double* z,
                                              double* distances2) const noexcept {
  // The foot of the perpendicular, a + u ab + v ac, is nearest if it is within the triangle, else a place of its sides.
  const auto squared_distance = [](const Triangle& t, const Packs& points) {
    const Packs p = points - t.a;
    const Pack along_ab = p.dot(t.ab), along_ac = p.dot(t.ac), height = p.dot(t.normal);
    const Pack u = (Pack(t.ac2) * along_ab - Pack(t.abac) * along_ac) * Pack(t.per_area);
    const Pack v = (Pack(t.ab2) * along_ac - Pack(t.abac) * along_ab) * Pack(t.per_area);
    const Mask within = u >= Pack(0.0) && v >= Pack(0.0) && u + v <= Pack(1.0);
    const Pack along_bc = along_ac - along_ab - Pack(t.abac) + Pack(t.ab2);  // (p - ab) (ac - ab)
    const Pack to_sides = simd::min(simd::min(squared_distance_to_side(p, t.ab, along_ab, t.per_ab2),
                                              squared_distance_to_side(p, t.ac, along_ac, t.per_ac2)),
                                    squared_distance_to_side(p - t.ab, t.ac - t.ab, along_bc, t.per_bc2));
    return simd::select(within, height * height, to_sides);
  };
  struct Waiting {
    Pack distance2;
    std::uint32_t node;
  };
  std::array<Waiting, kStack> stack;
  std::size_t size = 0;
  const Packs points{simd::load(x), simd::load(y), simd::load(z)};
  Pack best = simd::load(distances2);
  stack[size++] = {Pack(0.0), 0};
  while (size > 0) {
    const Waiting next = stack[--size];
    if (!simd::any(next.distance2 < best)) continue;
    const Node& node = nodes_[next.node];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      best = simd::min(best, squared_distance(triangles_[i], points));
    }
    if (node.count > 0) continue;
    Waiting near{squared_distance_to_box(nodes_[node.first].low, nodes_[node.first].high, points), node.first};
    Waiting far{squared_distance_to_box(nodes_[node.first + 1].low, nodes_[node.first + 1].high, points),
                node.first + 1};
    if (std::popcount(simd::bits(far.distance2 < near.distance2)) > 4) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
  simd::store(best, distances2);
}

double TriangleTree::first_hit(const Vec3& origin, const Vec3& direction, double from) const noexcept {
  std::array<std::uint32_t, kStack> stack;
  std::size_t size = 0;
  double best = kFarthest;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    double enter = from, leave = best;
    for (int k = 0; k < 3; ++k) {
      // A ray along a face of the box divides 0 by 0; the comparisons then leave the interval as it is.
      const double a = (node.low[k] - origin[k]) / direction[k], b = (node.high[k] - origin[k]) / direction[k];
      if (std::min(a, b) > enter) enter = std::min(a, b);
      if (std::max(a, b) < leave) leave = std::max(a, b);
    }
    if (enter > leave) continue;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Triangle& t = triangles_[i];
      const Vec3 normal = t.ab.cross(t.ac), to = t.a - origin;
      const double slope = direction.dot(normal);
      if (slope == 0.0) continue;
      const Vec3 across = direction.cross(to);
      const double u = -across.dot(t.ac) / slope, v = across.dot(t.ab) / slope, distance = to.dot(normal) / slope;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > from) best = std::min(best, distance);
    }
    if (node.count > 0) continue;
    stack[size++] = node.first + 1;
    stack[size++] = node.first;
  }
  return best;
}

}  // namespace hapbench
