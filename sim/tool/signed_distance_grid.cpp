#include "sim/tool/signed_distance_grid.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "sim/core/lanes.hpp"
#include "sim/tool/triangle_tree.hpp"
#include "sim/tool/winding_number.hpp"

namespace hapbench {
namespace {

/// Nodes between the mesh and the border on each side: three, so that the 27 around any point of the border are
/// outside.
constexpr double kBorder = 3.0;
constexpr double kMostBytes = 1024.0 * 1024.0 * 1024.0;
constexpr double kBytesPerNode = sizeof(double) + sizeof(std::uint8_t);
constexpr double kMostThin = 0.1;
/// Of the spacing: a vertex this far before a plane makes no body concave. Files in single precision round away less.
constexpr double kConvexWithin = 0.01;
/// Normals that differ by less are one.
constexpr double kSameNormal = 1e-6;
/// Faces that a flat tool slides on are few; those of a round one need no special treatment.
constexpr std::size_t kMostFaces = 64;

[[noreturn]] void refuse(const std::ostringstream& message) {
  throw std::invalid_argument(message.str());
}

std::ostream& operator<<(std::ostream& out, const GridNodes& nodes) {
  return out << nodes.count[0] << " x " << nodes.count[1] << " x " << nodes.count[2];
}

GridNodes nodes_around(const ClosedSurface& surface, double spacing) {
  std::ostringstream message;
  if (!(spacing > 0.0 && std::isfinite(spacing))) {
    message << "the spacing of a grid must be > 0, not " << spacing << " m";
    refuse(message);
  }
  const Vec3 extent = surface.high() - surface.low();
  // In double first: a spacing off by 1000 asks for more nodes than can be counted.
  const Vec3 wanted = (extent / spacing).array().ceil() + 2.0 * kBorder + 1.0;
  if (const double bytes = kBytesPerNode * wanted.prod(); !(bytes <= kMostBytes)) {
    message << "a grid of " << wanted.x() << " x " << wanted.y() << " x " << wanted.z() << " nodes, " << spacing
            << " m apart, would take " << bytes / kMostBytes << " GiB, more than 1; the mesh is " << extent.x() << " x "
            << extent.y() << " x " << extent.z() << " m large: is that its scale? If so, set the nodes "
            << SignedDistanceGrid::suggested_spacing(surface.vertices()) << " m apart";
    refuse(message);
  }
  GridNodes nodes{surface.low() - Vec3::Constant(kBorder * spacing), spacing, {}};
  for (int k = 0; k < 3; ++k) nodes.count[static_cast<std::size_t>(k)] = static_cast<std::size_t>(wanted[k]);
  // In the middle of what was rounded up. The nodes of a symmetric mesh are symmetric, too.
  for (int k = 0; k < 3; ++k)
    nodes.origin[k] = 0.5 * (surface.low()[k] + surface.high()[k] - (wanted[k] - 1.0) * spacing);
  return nodes;
}

double furthest(const ClosedSurface& surface) {
  double distance2 = 0.0;
  for (const Vec3& v : surface.vertices()) distance2 = std::max(distance2, v.squaredNorm());
  return std::sqrt(distance2);
}

Vec3 area_vector(const ClosedSurface& surface, const TriangleCorners& t) {
  const auto [a, b, c] = surface.corners(t);
  return 0.5 * (b - a).cross(c - a);
}

/// The vertices without those in the middle of flat triangles, which are not foremost alone in any direction.
std::vector<Vec3> corners_of(const ClosedSurface& surface) {
  std::vector<Vec3> sums(surface.vertices().size(), Vec3::Zero());
  std::vector<double> counts(sums.size(), 0.0);
  for (const TriangleCorners& t : surface.triangles()) {
    const Vec3 normal = area_vector(surface, t).stableNormalized();
    for (const std::uint32_t v : t) {
      sums[v] += normal;
      counts[v] += 1.0;
    }
  }
  std::vector<Vec3> corners;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    const bool flat = sums[v].norm() > counts[v] * (1.0 - 1e-14);
    if (counts[v] > 0.0 && !flat) corners.push_back(surface.vertices()[v]);
  }
  return corners;
}

/// A node that is inside more than once, or less than not at all.
void check_winding(const std::vector<std::int8_t>& numbers, const GridNodes& nodes) {
  std::size_t wrong = 0;
  std::ostringstream message;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] == 0 || numbers[i] == 1 || wrong++ > 0) continue;
    const std::size_t column = i / nodes.count[2];
    const Vec3 place = nodes.place(column / nodes.count[1], column % nodes.count[1], i % nodes.count[2]);
    message << "the mesh passes through itself: it encloses [" << place.x() << ", " << place.y() << ", " << place.z()
            << "] m " << int{numbers[i]} << " times";
  }
  if (wrong == 0) return;
  message << ", and so " << wrong << " of " << nodes << " nodes; unite its parts, all counter-clockwise from outside";
  refuse(message);
}

/// The share of the area from which less than `thickness` leads inwards to another triangle.
double thin_share(const ClosedSurface& surface, const TriangleTree& tree, double thickness) {
  std::vector<double> thin(surface.triangles().size(), -1.0);
  std::vector<double> areas(thin.size());
  tbb::parallel_for(std::size_t{0}, thin.size(), [&](std::size_t i) {
    const auto [a, b, c] = surface.corners(surface.triangles()[i]);
    const Vec3 area = area_vector(surface, surface.triangles()[i]);
    areas[i] = area.norm();
    // Beyond the rounding of its own plane.
    if (areas[i] > 0.0) thin[i] = tree.first_hit((a + b + c) / 3.0, -area / areas[i], 1e-6 * thickness);
  });
  double all = 0.0, too_thin = 0.0, thinnest = thickness;
  std::size_t where = 0;
  for (std::size_t i = 0; i < thin.size(); ++i) {
    all += areas[i];
    if (thin[i] < 0.0 || thin[i] >= thickness) continue;
    too_thin += areas[i];
    if (thin[i] < thinnest) {
      thinnest = thin[i];
      where = i;
    }
  }
  if (too_thin <= kMostThin * all) return too_thin / all;
  const auto [a, b, c] = surface.corners(surface.triangles()[where]);
  const Vec3 place = (a + b + c) / 3.0;
  std::ostringstream message;
  message << "the mesh is thinner than its grid: " << std::round(100.0 * too_thin / all)
          << " % of its surface is less than two spacings (" << thickness << " m) thick, the thinnest place "
          << thinnest << " m at [" << place.x() << ", " << place.y() << ", " << place.z()
          << "] m; set the nodes at most " << 0.5 * thinnest << " m apart, or take a thicker mesh";
  refuse(message);
}

}  // namespace

SignedDistanceGrid::SignedDistanceGrid(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles,
                                       double spacing)
    : SignedDistanceGrid(ClosedSurface(vertices, triangles), spacing) {}

SignedDistanceGrid::SignedDistanceGrid(const ClosedSurface& surface, double spacing)
    : nodes_(nodes_around(surface, spacing)),
      low_(surface.low() - Vec3::Constant(error_bound())),
      high_(surface.high() + Vec3::Constant(error_bound())),
      reach_(furthest(surface) + error_bound()),
      volume_(surface.volume()),
      vertices_(surface.vertices()),
      hull_(corners_of(surface)) {
  const TriangleTree tree(surface);
  thin_share_ = hapbench::thin_share(surface, tree, 2.0 * spacing);
  fill(surface, tree);
  classify();
  find_faces(surface);
}

double SignedDistanceGrid::suggested_spacing(std::span<const Vec3> vertices) {
  Vec3 low = vertices.front(), high = low;
  for (const Vec3& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  // Of the 128 nodes along an edge of a cube, 7 lie beyond it. A flat box has more nodes for that, but not many times
  // as many.
  const Vec3 extent = (high - low).cwiseMax(0.01 * (high - low).maxCoeff());
  return std::cbrt(extent.prod()) / 121.0;
}

double SignedDistanceGrid::error_bound() const noexcept {
  return 0.5 * std::numbers::sqrt3 * nodes_.spacing;
}

std::size_t SignedDistanceGrid::bytes() const noexcept {
  return values_.size() * sizeof(double) + kinds_.size();
}

void SignedDistanceGrid::fill(const ClosedSurface& surface, const TriangleTree& tree) {
  const std::vector<std::int8_t> numbers = winding_numbers(surface, nodes_);
  check_winding(numbers, nodes_);
  // Rows of three nodes are read as four.
  values_.assign(nodes_.size() + 1, 0.0);
  tbb::parallel_for(std::size_t{0}, nodes_.count[0] * nodes_.count[1], [&](std::size_t column) {
    alignas(64) std::array<double, simd::lanes> x, y, z, distances2;
    x.fill(nodes_.coordinate(0, column / nodes_.count[1]));
    y.fill(nodes_.coordinate(1, column % nodes_.count[1]));
    double last = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < nodes_.count[2]; k += simd::lanes) {
      for (std::size_t n = 0; n < simd::lanes; ++n) {
        z[n] = nodes_.coordinate(2, k + n);
        // A node is at most as much further away than the last one of before as it is from that.
        const double at_most = last + static_cast<double>(n + 1) * nodes_.spacing;
        distances2[n] = (1.0 + 1e-9) * at_most * at_most;
      }
      tree.lower_to_squared_distances(x.data(), y.data(), z.data(), distances2.data());
      last = std::sqrt(distances2.back());
      for (std::size_t n = 0; n < std::min(simd::lanes, nodes_.count[2] - k); ++n) {
        const std::size_t i = column * nodes_.count[2] + k + n;
        const double distance = std::sqrt(distances2[n]);
        values_[i] = numbers[i] == 0 ? distance : -distance;
      }
    }
  });
  half_width_ = -*std::min_element(values_.begin(), values_.end());
  if (half_width_ > 0.0) return;
  std::ostringstream message;
  message << "the mesh is so thin that none of its grid's nodes lies in it; set them less than " << nodes_.spacing
          << " m apart";
  refuse(message);
}

void SignedDistanceGrid::classify() {
  kinds_.assign(nodes_.size(), outside);
  tbb::parallel_for(std::size_t{1}, nodes_.count[0] - 1, [&](std::size_t i) {
    for (std::size_t j = 1; j + 1 < nodes_.count[1]; ++j) {
      for (std::size_t k = 1; k + 1 < nodes_.count[2]; ++k) {
        bool any_inside = false, any_outside = false;
        for (std::size_t a = i - 1; a <= i + 1; ++a) {
          for (std::size_t b = j - 1; b <= j + 1; ++b) {
            for (std::size_t c = k - 1; c <= k + 1; ++c)
              (values_[nodes_.index(a, b, c)] > 0.0 ? any_outside : any_inside) = true;
          }
        }
        kinds_[nodes_.index(i, j, k)] = !any_inside ? outside : any_outside ? mixed : inside;
      }
    }
  });
}

/// Whether the body is convex and, if so, its largest flat faces.
void SignedDistanceGrid::find_faces(const ClosedSurface& surface) {
  const double tolerance = kConvexWithin * nodes_.spacing;
  // Of a convex body triangles with the same normal lie in the same plane.
  std::map<std::array<long, 3>, Vec3> areas;
  convex_ = true;
  for (const TriangleCorners& t : surface.triangles()) {
    const Vec3 area = area_vector(surface, t);
    const Vec3 normal = area.stableNormalized();
    if (hull_.support(normal) - normal.dot(surface.vertices()[t[0]]) > tolerance) {
      convex_ = false;
      return;
    }
    const Vec3 rounded = normal / kSameNormal;
    areas.try_emplace({std::lround(rounded.x()), std::lround(rounded.y()), std::lround(rounded.z())}, Vec3::Zero())
        .first->second += area;
  }
  std::vector<Vec3> largest;
  for (const auto& [normal, area] : areas) {
    if (area.norm() >= half_width_ * half_width_) largest.push_back(area);
  }
  std::stable_sort(largest.begin(), largest.end(),
                   [](const Vec3& a, const Vec3& b) { return a.squaredNorm() > b.squaredNorm(); });
  largest.resize(std::min(largest.size(), kMostFaces));
  for (const Vec3& area : largest) faces_.push_back({area.normalized(), hull_.support(area.normalized())});
}

}  // namespace hapbench
