#include "sim/mesh/mesh_parts.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>

namespace hapbench {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
/// Each part is looked for in each of these; with all of them a mesh of a million crumbs would take minutes.
constexpr std::size_t kMostHolders = 1000;

/// Indices of the hinges of each triangle, at its corners.
std::vector<std::array<std::uint32_t, 3>> hinges_at_triangles(std::size_t triangles, const std::vector<Hinge>& hinges) {
  std::vector<std::array<std::uint32_t, 3>> at(triangles, {kNone, kNone, kNone});
  for (std::uint32_t h = 0; h < hinges.size(); ++h) {
    for (std::size_t side = 0; side < 2; ++side) at[hinges[h].triangles[side]][hinges[h].corners[side]] = h;
  }
  return at;
}

/// What decides which way a part is turned.
struct Shape {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());  ///< bounding box
  Vec3 high = -low;
  double volume = 0.0;  ///< enclosed; negative when normals point inwards

  double size() const { return (high - low).norm(); }
  bool holds(const Shape& other) const {
    return (other.low.array() >= low.array()).all() && (other.high.array() <= high.array()).all();
  }
  /// By more than rounding: two sheets back to back enclose nothing.
  bool is_inside_out() const { return volume < -1e-12 * size() * size() * size(); }
};

}  // namespace

MeshParts::MeshParts(std::size_t triangles, const std::vector<Hinge>& hinges)
    : hinges_(hinges), part_(triangles, kNone), turned_(triangles, false) {
  const auto at = hinges_at_triangles(triangles, hinges);
  std::vector<std::uint32_t> open;
  for (std::uint32_t first = 0; first < triangles; ++first) {
    if (part_[first] != kNone) continue;
    const auto part = static_cast<std::uint32_t>(count());
    closed_.push_back(true);
    part_[first] = part;
    open.push_back(first);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (const std::uint32_t h : at[t]) {
        if (h == kNone) {
          closed_[part] = false;
          continue;
        }
        const Hinge& hinge = hinges[h];
        const std::uint32_t neighbour = hinge.triangles[hinge.triangles[0] == t ? 1 : 0];
        if (part_[neighbour] != kNone) continue;
        part_[neighbour] = part;
        turned_[neighbour] = hinge.opposed ? turned_[t] : !turned_[t];
        open.push_back(neighbour);
      }
    }
  }
}

std::optional<Hinge> MeshParts::contradiction() const {
  for (const Hinge& hinge : hinges_) {
    const bool alike = turned_[hinge.triangles[0]] == turned_[hinge.triangles[1]];
    if (alike != hinge.opposed) return hinge;
  }
  return std::nullopt;
}

void MeshParts::turn(const std::vector<bool>& parts) {
  for (std::size_t t = 0; t < part_.size(); ++t) {
    if (parts[part_[t]]) turned_[t] = !turned_[t];
  }
}

std::size_t MeshParts::follow_majority() {
  std::vector<std::int64_t> balance(count(), 0);  // turned less kept
  for (std::size_t t = 0; t < part_.size(); ++t) balance[part_[t]] += turned_[t] ? 1 : -1;
  std::vector<bool> mostly_turned;
  mostly_turned.reserve(count());
  for (const std::int64_t b : balance) mostly_turned.push_back(b > 0);
  turn(mostly_turned);
  return static_cast<std::size_t>(std::count(turned_.begin(), turned_.end(), true));
}

std::size_t MeshParts::turn_outwards(const std::vector<Vec3>& vertices,
                                     const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Shape> shapes(count());
  for (std::size_t t = 0; t < part_.size(); ++t) {
    Shape& shape = shapes[part_[t]];
    for (const std::uint32_t corner : triangles[t]) {
      shape.low = shape.low.cwiseMin(vertices[corner]);
      shape.high = shape.high.cwiseMax(vertices[corner]);
    }
  }
  for (std::size_t t = 0; t < part_.size(); ++t) {
    Shape& shape = shapes[part_[t]];
    // Tetrahedra with their tip at the part: at the origin, which may be far away, the sum would cancel out.
    const auto& [i, j, k] = triangles[t];
    const Vec3 a = vertices[i] - shape.low, b = vertices[j] - shape.low, c = vertices[k] - shape.low;
    shape.volume += (turned_[t] ? -1.0 : 1.0) * a.dot(b.cross(c)) / 6.0;
  }

  std::vector<std::uint32_t> largest_first(count()), outermost;
  std::iota(largest_first.begin(), largest_first.end(), 0u);
  std::stable_sort(largest_first.begin(), largest_first.end(),
                   [&](std::uint32_t p, std::uint32_t q) { return shapes[p].size() > shapes[q].size(); });
  std::vector<bool> inside_out(count(), false);
  for (const std::uint32_t p : largest_first) {
    if (!closed_[p]) continue;
    const auto outer =
        std::find_if(outermost.begin(), outermost.end(), [&](std::uint32_t q) { return shapes[q].holds(shapes[p]); });
    inside_out[p] = outer == outermost.end() ? shapes[p].is_inside_out() : inside_out[*outer];
    if (outer == outermost.end() && outermost.size() < kMostHolders) outermost.push_back(p);
  }
  turn(inside_out);
  return static_cast<std::size_t>(std::count(inside_out.begin(), inside_out.end(), true));
}

}  // namespace hapbench
