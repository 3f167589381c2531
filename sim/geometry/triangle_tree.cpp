#include "sim/geometry/triangle_tree.hpp"

#include <bit>
#include <functional>
#include <limits>
#include <utility>

#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr std::uint32_t kMaxLeafTriangles = 4;  ///< maximum number of triangles in a leaf
/// Size of the search stack. The tree of 2^32 triangles has 32 levels, and a search stores one node for each level.
constexpr std::size_t kStackSize = 64;
/// nearest() skips a triangle if the squared distance of its plane exceeds the smallest squared distance found so far
/// by this factor.
constexpr double kPlaneMargin = 1.0 + 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using simd::Mask, simd::Pack;

/// Eight points or vectors.
struct Packs {
  Pack x, y, z;
  Packs operator-(const Vec3& from) const { return {x - Pack(from.x()), y - Pack(from.y()), z - Pack(from.z())}; }
  Pack dot(const Vec3& v) const { return x * Pack(v.x()) + y * Pack(v.y()) + z * Pack(v.z()); }
};

/// Returns the squared distances from eight points to an edge. `from`: points relative to one end of the edge;
/// `along`: dot products of the vectors `from` with the edge vector `side`; `per_length2`: 1 / |side|^2.
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

struct ClosestPoint {
  Vec3 from_a;
  unsigned corners;  ///< see TriangleTree::Nearest
};

/// Returns the point of a triangle closest to p (C. Ericson, Real-Time Collision Detection, 2005, 5.1.5): determines
/// whether the closest point lies on a corner, on an edge or inside the triangle. p and the result are relative to
/// corner a. ab2, abac and ac2 are the dot products of ab and ac. If the triangle has no area, the closest point is on
/// a corner or an edge.
ClosestPoint closest_point(const Vec3& p, const Vec3& ab, const Vec3& ac, double ab2, double abac, double ac2) {
  const double along_ab = p.dot(ab), along_ac = p.dot(ac);
  if (along_ab <= 0.0 && along_ac <= 0.0) return {Vec3::Zero(), 1u};
  const double b_ab = along_ab - ab2, b_ac = along_ac - abac;  // dot products relative to corner b
  if (b_ab >= 0.0 && b_ac <= b_ab) return {ab, 2u};
  const double c_ab = along_ab - abac, c_ac = along_ac - ac2;  // dot products relative to corner c
  if (c_ac >= 0.0 && c_ab <= c_ac) return {ac, 4u};
  const double at_c = along_ab * b_ac - b_ab * along_ac;
  if (at_c <= 0.0 && along_ab >= 0.0 && b_ab <= 0.0) return {along_ab / ab2 * ab, 3u};
  const double at_b = c_ab * along_ac - along_ab * c_ac;
  if (at_b <= 0.0 && along_ac >= 0.0 && c_ac <= 0.0) return {along_ac / ac2 * ac, 5u};
  const double at_a = b_ab * c_ac - c_ab * b_ac;
  const double to_c = b_ac - b_ab, to_b = c_ab - c_ac;
  if (at_a <= 0.0 && to_c >= 0.0 && to_b >= 0.0) return {ab + to_c / (to_c + to_b) * (ac - ab), 6u};
  const double whole = at_a + at_b + at_c;
  return {at_b / whole * ab + at_c / whole * ac, 7u};
}

/// Returns twice the signed area of the triangle with corners a, b and (x, y) in the xy plane, positive if (x, y)
/// is to the left of the edge from a to b. The edge from b to a gives exactly the negative number.
double side_of_edge(const Vec3& a, const Vec3& b, double x, double y) {
  const auto area = [x, y](const Vec3& from, const Vec3& to) {
    return (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
  };
  return before(a, b) ? area(a, b) : -area(b, a);
}

/// Returns true if the vertical line passes to the left of the edge from a to b. `side`: result of side_of_edge() for
/// the line and the edge. A line that meets the edge is treated as if it were moved slightly in x, and much less in y.
bool left_of_edge(double side, const Vec3& a, const Vec3& b) {
  if (side != 0.0) return side > 0.0;
  return a.y() != b.y() ? b.y() < a.y() : b.x() > a.x();
}

}  // namespace

std::optional<Crossing> vertical_crossing(const std::array<Vec3, 3>& t, double x, double y) {
  const double a = side_of_edge(t[1], t[2], x, y), b = side_of_edge(t[2], t[0], x, y),
               c = side_of_edge(t[0], t[1], x, y);
  // The line meets the triangle if it is on the same side of all three edges.
  const bool left = left_of_edge(a, t[1], t[2]);
  if (left_of_edge(b, t[2], t[0]) != left || left_of_edge(c, t[0], t[1]) != left) return {};
  // Interpolate z at the line.
  const double whole = a + b + c;
  const double z = whole != 0.0 ? (a * t[0].z() + b * t[1].z() + c * t[2].z()) / whole : t[0].z();
  // Triangles that face up are counter-clockwise seen from above; an upward line leaves the solid through such a
  // triangle.
  return Crossing{z, left ? -1 : 1};
}

TriangleTree::Triangle::Triangle(std::uint32_t number_, const Vec3& a_, const Vec3& b, const Vec3& c)
    : a(a_),
      ab(b - a_),
      ac(c - a_),
      normal(ab.cross(ac).stableNormalized()),
      ab2(ab.squaredNorm()),
      abac(ab.dot(ac)),
      ac2(ac.squaredNorm()),
      per_ab2(1.0 / ab2),
      per_bc2(1.0 / (c - b).squaredNorm()),
      per_ac2(1.0 / ac2),
      number(number_) {
  const double area2 = ab2 * ac2 - abac * abac;
  per_area = area2 > 0.0 ? 1.0 / area2 : std::numeric_limits<double>::quiet_NaN();
}

TriangleTree::TriangleTree(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles) {
  std::vector<Item> items;
  items.reserve(triangles.size());
  for (const auto& [i, j, k] : triangles) {
    const Vec3 &a = vertices[i], b = vertices[j], c = vertices[k];
    items.push_back(
        {a + b + c, a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), static_cast<std::uint32_t>(items.size())});
  }
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), 0, static_cast<std::uint32_t>(items.size())});
  // The loop also visits the children that split() appends.
  for (std::size_t node = 0; node < nodes_.size(); ++node) split(node, items);
  triangles_.reserve(items.size());
  for (const Item& item : items) {
    const auto& [i, j, k] = triangles[item.number];
    triangles_.emplace_back(item.number, vertices[i], vertices[j], vertices[k]);
  }
}

/// Splits the triangles of a node into two halves across the longest side of their box, unless they fit into a
/// leaf.
void TriangleTree::split(std::size_t node, std::vector<Item>& items) {
  const auto [first, count] = std::pair(nodes_[node].first, nodes_[node].count);
  const auto begin = items.begin() + first, end = begin + count;
  Vec3 low = begin->low, high = begin->high;
  std::for_each(begin, end, [&](const Item& item) {
    low = low.cwiseMin(item.low);
    high = high.cwiseMax(item.high);
  });
  nodes_[node].low = low;
  nodes_[node].high = high;
  if (count <= kMaxLeafTriangles) return;
  // Divide the triangles at the median of their centroids.
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::nth_element(begin, begin + count / 2, end,
                   [axis](const Item& a, const Item& b) { return a.middle[axis] < b.middle[axis]; });
  nodes_[node].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].count = 0;
  nodes_.push_back({low, high, first, count / 2});
  nodes_.push_back({low, high, first + count / 2, count - count / 2});
}

/// Calls `use` with the triangles of the leaves, closest boxes first. `distance_to(node)` returns the distance of a
/// box, `is_less` compares two distances, and `may_be_nearer(distance)` returns false for a box that need not be
/// searched. `may_be_nearer` is called when the search reaches the box.
template <class DistanceTo, class IsLess, class MayBeNearer, class Use>
[[gnu::always_inline]] inline void TriangleTree::visit_nearest_first(const DistanceTo& distance_to,
                                                                     const IsLess& is_less,
                                                                     const MayBeNearer& may_be_nearer,
                                                                     const Use& use) const {
  using Distance = decltype(distance_to(nodes_[0]));
  struct Waiting {
    Distance distance;
    std::uint32_t node;
  };
  std::array<Waiting, kStackSize> stack;
  std::size_t size = 0;
  stack[size++] = {distance_to(nodes_[0]), 0};
  while (size > 0) {
    const Waiting next = stack[--size];
    if (!may_be_nearer(next.distance)) continue;
    const Node& node = nodes_[next.node];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) use(triangles_[i]);
    if (node.count > 0) continue;
    Waiting near{distance_to(nodes_[node.first]), node.first}, far{distance_to(nodes_[node.first + 1]), node.first + 1};
    if (is_less(far.distance, near.distance)) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
}

void TriangleTree::lower_to_squared_distances(const double* x, const double* y, const double* z,
                                              double* distances2) const noexcept {
  // The foot of the perpendicular, a + u ab + v ac, is the closest point if it lies in the triangle. Otherwise the
  // closest point lies on an edge.
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
  const Packs points{simd::load(x), simd::load(y), simd::load(z)};
  Pack best = simd::load(distances2);
  visit_nearest_first([&](const Node& node) { return squared_distance_to_box(node.low, node.high, points); },
                      [](const Pack& a, const Pack& b) { return std::popcount(simd::bits(a < b)) > 4; },
                      [&](const Pack& distance2) { return simd::any(distance2 < best); },
                      [&](const Triangle& t) { best = simd::min(best, squared_distance(t, points)); });
  simd::store(best, distances2);
}

std::optional<TriangleTree::Nearest> TriangleTree::nearest(const Vec3& point, double at_most) const noexcept {
  Nearest best{at_most * at_most, 0, 0, Vec3::Zero()};
  visit_nearest_first(
      [&](const Node& node) {
        const Vec3 inside = point.cwiseMax(node.low).cwiseMin(node.high);
        return (point - inside).squaredNorm();
      },
      std::less(), [&](double distance2) { return !(distance2 >= best.distance2); },
      [&](const Triangle& t) {
        // No point of the triangle is closer than its plane. The margin exceeds the rounding of both distances.
        const double height = (point - t.a).dot(t.normal);
        if (height * height > kPlaneMargin * best.distance2) return;
        const ClosestPoint closest = closest_point(point - t.a, t.ab, t.ac, t.ab2, t.abac, t.ac2);
        const double distance2 = (point - t.a - closest.from_a).squaredNorm();
        if (distance2 < best.distance2) best = {distance2, t.number, closest.corners, t.a + closest.from_a};
      });
  if (best.corners == 0) return std::nullopt;
  return best;
}

template <class Enters, class Use>
void TriangleTree::visit(const Enters& enters, const Use& use) const {
  std::array<std::uint32_t, kStackSize> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const Node& node = nodes_[stack[--size]];
    if (!enters(node)) continue;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) use(triangles_[i]);
    if (node.count > 0) continue;
    stack[size++] = node.first + 1;
    stack[size++] = node.first;
  }
}

int TriangleTree::winding_number(const Vec3& point, std::span<const Vec3> vertices,
                                 std::span<const TriangleCorners> triangles) const noexcept {
  int above = 0;
  const auto enters = [&point](const Node& node) {
    const bool beside = (point.head<2>().array() < node.low.head<2>().array()).any() ||
                        (point.head<2>().array() > node.high.head<2>().array()).any();
    return !beside && !(point.z() >= node.high.z());
  };
  visit(enters, [&](const Triangle& t) {
    const auto& [a, b, c] = triangles[t.number];
    const auto met = vertical_crossing({vertices[a], vertices[b], vertices[c]}, point.x(), point.y());
    if (met && met->z > point.z()) above += met->step;
  });
  return -above;
}

double TriangleTree::first_hit(const Vec3& origin, const Vec3& direction, double from) const noexcept {
  double best = kInfinity;
  const auto enters = [&](const Node& node) {
    double enter = from, leave = best;
    for (int k = 0; k < 3; ++k) {
      // For a ray parallel to a face of the box, 0 / 0 gives NaN; the comparisons then leave the interval
      // unchanged.
      const double a = (node.low[k] - origin[k]) / direction[k], b = (node.high[k] - origin[k]) / direction[k];
      if (std::min(a, b) > enter) enter = std::min(a, b);
      if (std::max(a, b) < leave) leave = std::max(a, b);
    }
    return !(enter > leave);
  };
  visit(enters, [&](const Triangle& t) {
    // Solve origin + distance * direction = a + u ab + v ac.
    const Vec3 normal = t.ab.cross(t.ac), to = t.a - origin;
    const double slope = direction.dot(normal);
    if (slope == 0.0) return;
    const Vec3 across = direction.cross(to);
    const double u = -across.dot(t.ac) / slope, v = across.dot(t.ab) / slope, distance = to.dot(normal) / slope;
    if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > from) best = std::min(best, distance);
  });
  return best;
}

}  // namespace hapbench
