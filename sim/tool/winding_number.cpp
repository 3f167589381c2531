#include "sim/tool/winding_number.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hapbench {
namespace {

/// Where the ray passes a triangle: a step of the winding number of the points above.
struct Crossing {
  double z;
  int step;
};

/// Twice the area of the edge from a to b and the ray at (x, y), positive to the left of the edge: of both directions
/// of an edge the same number but for the sign, to the bit.
double side_of_edge(const Vec3& a, const Vec3& b, double x, double y) {
  const auto area = [x, y](const Vec3& from, const Vec3& to) {
    return (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
  };
  const bool forwards = std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  return forwards ? area(a, b) : -area(b, a);
}

/// On which side of the edge the ray passes: one on the edge counts as moved by a little in x, and by far less in y.
bool left_of_edge(double side, const Vec3& a, const Vec3& b) {
  if (side != 0.0) return side > 0.0;
  return a.y() != b.y() ? b.y() < a.y() : b.x() > a.x();
}

std::optional<Crossing> crossing(const std::array<Vec3, 3>& t, double x, double y) {
  const double a = side_of_edge(t[1], t[2], x, y), b = side_of_edge(t[2], t[0], x, y),
               c = side_of_edge(t[0], t[1], x, y);
  const bool left = left_of_edge(a, t[1], t[2]);
  if (left_of_edge(b, t[2], t[0]) != left || left_of_edge(c, t[0], t[1]) != left) return {};
  const double whole = a + b + c;
  const double z = whole != 0.0 ? (a * t[0].z() + b * t[1].z() + c * t[2].z()) / whole : t[0].z();
  // Seen from above, triangles that face up go round to the left: there the ray leaves the solid.
  return Crossing{z, left ? -1 : 1};
}

/// The nodes of a row that lie within [low, high].
std::pair<std::size_t, std::size_t> nodes_within(const GridNodes& nodes, int axis, double low, double high) {
  // One more on each side for the rounding of the division.
  const double first = std::floor((low - nodes.origin[axis]) / nodes.spacing) - 1.0;
  const double last = std::ceil((high - nodes.origin[axis]) / nodes.spacing) + 1.0;
  const auto count = static_cast<double>(nodes.count[static_cast<std::size_t>(axis)]);
  return {static_cast<std::size_t>(std::clamp(first, 0.0, count)),
          static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, count))};
}

}  // namespace

std::vector<std::int8_t> winding_numbers(const ClosedSurface& surface, const GridNodes& nodes) {
  // The triangles that each layer of columns meets.
  std::vector<std::vector<std::uint32_t>> layers(nodes.count[0]);
  for (std::uint32_t t = 0; t < surface.triangles().size(); ++t) {
    const auto [a, b, c] = surface.corners(surface.triangles()[t]);
    const auto [first, last] = nodes_within(nodes, 0, std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}));
    for (std::size_t i = first; i < last; ++i) layers[i].push_back(t);
  }
  std::vector<std::int8_t> numbers(nodes.size());
  tbb::parallel_for(std::size_t{0}, nodes.count[0], [&](std::size_t i) {
    std::vector<std::vector<Crossing>> columns(nodes.count[1]);
    const double x = nodes.coordinate(0, i);
    for (const std::uint32_t t : layers[i]) {
      const std::array<Vec3, 3> corners = surface.corners(surface.triangles()[t]);
      const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
      const auto [first, last] = nodes_within(nodes, 1, low, high);
      for (std::size_t j = first; j < last; ++j) {
        if (const auto met = crossing(corners, x, nodes.coordinate(1, j))) columns[j].push_back(*met);
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
