#include "sim/tool/signed_distance_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "sim/core/aligned.hpp"
#include "sim/core/math.hpp"
#include "sim/core/parallel.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kEdge = 16;  ///< cells along an edge of the cube of directions
constexpr std::size_t kCells = 6 * kEdge * kEdge;
/// Differences of distance below this fraction of the body's size are treated as rounding.
constexpr double kTie = 1e-9;

/// Returns the row or column, 0 to kEdge - 1, of the direction cell (SupportTable) that contains a point on the face of
/// a cube. `coordinate`: coordinate of the point along the face, in [-1, 1].
std::size_t cell_along(double coordinate) {
  return std::min(kEdge - 1, static_cast<std::size_t>(0.5 * (coordinate + 1.0) * static_cast<double>(kEdge)));
}

/// Returns the direction cell that contains a direction; 0 for a direction that is zero or not finite.
std::size_t cell_of(const Vec3& u) {
  Eigen::Index axis = 0;
  const double largest = u.cwiseAbs().maxCoeff(&axis);
  if (!(largest > 0.0 && largest < std::numeric_limits<double>::infinity())) return 0;
  const std::size_t side = 2 * static_cast<std::size_t>(axis) + (u[axis] < 0.0 ? 1 : 0);
  return (side * kEdge + cell_along(u[(axis + 1) % 3] / largest)) * kEdge + cell_along(u[(axis + 2) % 3] / largest);
}

/// Returns the unit direction at position (a, b) in a cell; a and b run from 0 to 1 across the cell.
Vec3 direction_in(std::size_t cell, double a, double b) {
  const auto along = [](std::size_t i, double t) {
    return 2.0 * (static_cast<double>(i) + t) / static_cast<double>(kEdge) - 1.0;
  };
  const std::size_t side = cell / (kEdge * kEdge);
  const auto axis = static_cast<Eigen::Index>(side / 2);
  Vec3 u;
  u[axis] = side % 2 == 0 ? 1.0 : -1.0;
  u[(axis + 1) % 3] = along(cell / kEdge % kEdge, a);
  u[(axis + 2) % 3] = along(cell % kEdge, b);
  return u.normalized();
}

/// Returns the indices of the points that may be extreme along some direction in the cell (see SupportTable).
std::vector<std::uint32_t> support_candidates(const std::vector<Vec3>& points, std::size_t cell, double tie) {
  const Vec3 middle = direction_in(cell, 0.5, 0.5);
  // Great circles bound a cell, so its corners are farthest from its middle.
  double radius = 0.0;
  for (const double a : {0.0, 1.0}) {
    for (const double b : {0.0, 1.0}) radius = std::max(radius, (direction_in(cell, a, b) - middle).norm());
  }
  const auto behind = [&](const Vec3& a, const Vec3& b) { return a.dot(middle) < b.dot(middle); };
  const Vec3& first = *std::max_element(points.begin(), points.end(), behind);
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (middle.dot(first - points[i]) <= radius * (points[i] - first).norm() + tie)
      found.push_back(static_cast<std::uint32_t>(i));
  }
  return found;
}

/// Smallest distance of the mesh from the border of the grid, in node spacings, on each side. With three spacings, all
/// 27 nodes around a node of the second layer from the border are outside of the body.
constexpr double kMarginNodes = 3.0;
constexpr double kMaxBytes = 1024.0 * 1024.0 * 1024.0;
constexpr double kBytesPerNode = sizeof(double) + sizeof(std::uint8_t);
// Largest fraction of the surface that may be thinner than two spacings.
constexpr double kMaxThinFraction = 0.1;
/// A body counts as convex if no vertex lies farther than this, in spacings, in front of the plane of a triangle. This
/// is more than the rounding of mesh files in single precision.
constexpr double kConvexWithin = 0.01;
/// Step to which the components of unit normals are rounded. Normals with the same rounded components count as equal.
constexpr double kSameNormal = 1e-6;
/// Maximum number of flat faces. A flat tool slides on few faces, and the faces of a round tool need no special
/// treatment.
constexpr std::size_t kMaxFaces = 64;

double suggested_for(const Vec3& extent) {
  // A cube gets 128 nodes along each edge: 121 across the cube and 7 in the margins. Each extent counts as at least
  // 1 % of the largest. Otherwise the grid of a flat box, which consists mostly of margins, would have too many
  // nodes.
  return math::pow(extent.cwiseMax(0.01 * extent.maxCoeff()).prod(), 1.0 / 3.0) / 121.0;
}

/// Returns the number of nodes along each axis, as doubles, because with a spacing wrong by a factor of 1000 the
/// number may not fit into an integer. Throws std::invalid_argument if the grid would take more than 1 GiB.
Vec3 node_counts(const Vec3& extent, double spacing) {
  if (!(spacing > 0.0 && std::isfinite(spacing))) refuse("the spacing of a grid must be > 0, not ", spacing, " m");
  const Vec3 wanted = (extent / spacing).array().ceil() + 2.0 * kMarginNodes + 1.0;
  if (const double bytes = kBytesPerNode * wanted.prod(); !(bytes <= kMaxBytes)) {
    refuse("a grid of ", wanted.x(), " x ", wanted.y(), " x ", wanted.z(), " nodes, ", spacing, " m apart, would take ",
           bytes / kMaxBytes, " GiB, more than 1; the mesh is ", extent.x(), " x ", extent.y(), " x ", extent.z(),
           " m large: is its scale right? If so, set the nodes ", suggested_for(extent), " m apart");
  }
  return wanted;
}

GridNodes nodes_around(const ClosedSurface& surface, double spacing) {
  const Box& box = surface.box();
  const Vec3 wanted = node_counts(box.size(), spacing);
  // Centre the grid, so that the nodes around a symmetric mesh are symmetric.
  GridNodes nodes{0.5 * (box.min + box.max - (wanted - Vec3::Ones()) * spacing), spacing, {}};
  for (int k = 0; k < 3; ++k) nodes.count[static_cast<std::size_t>(k)] = static_cast<std::size_t>(wanted[k]);
  return nodes;
}

/// Returns the normal of a triangle times its area [m^2].
Vec3 area_vector(const ClosedSurface& surface, const TriangleCorners& t) {
  const auto [a, b, c] = surface.corners(t);
  return 0.5 * (b - a).cross(c - a);
}

/// Returns the vertices whose adjacent triangles are not all coplanar. The other vertices are not needed to find
/// extreme points: none of them is the only extreme point along a direction.
std::vector<Vec3> corners_of(const ClosedSurface& surface) {
  // Sum the unit normals of the triangles at each vertex. The normals are parallel if the length of the sum equals the
  // number of the triangles.
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

/// Throws std::invalid_argument if the winding number at a node is neither 0 nor 1.
void check_winding(const std::vector<std::int8_t>& numbers, const GridNodes& nodes) {
  const auto is_wrong = [](std::int8_t number) { return number != 0 && number != 1; };
  const auto first = std::find_if(numbers.begin(), numbers.end(), is_wrong);
  if (first == numbers.end()) return;
  const auto i = static_cast<std::size_t>(first - numbers.begin()), column = i / nodes.count[2];
  const Vec3 position = nodes.position(column / nodes.count[1], column % nodes.count[1], i % nodes.count[2]);
  refuse("the mesh intersects itself: it encloses [", coordinates(position), "] m ", int{*first}, " times, and so ",
         std::count_if(first, numbers.end(), is_wrong), " of ", nodes.count[0], " x ", nodes.count[1], " x ",
         nodes.count[2],
         " nodes; unite its parts, with the corners of all triangles counter-clockwise, seen from outside");
}

/// Throws std::invalid_argument if more than a tenth of the surface is thinner than `thickness` [m]. The thickness
/// is the distance from the middle of a triangle, along its inward normal, to the next triangle.
void check_thickness(const ClosedSurface& surface, const TriangleTree& tree, double thickness) {
  std::vector<double> thin(surface.triangles().size(), -1.0);
  std::vector<double> areas(thin.size());
  parallel_for(std::size_t{0}, thin.size(), [&](std::size_t i) {
    const auto [a, b, c] = surface.corners(surface.triangles()[i]);
    const Vec3 area = area_vector(surface, surface.triangles()[i]);
    areas[i] = area.norm();
    // The ray starts slightly away from the triangle, so that rounding does not make it hit this triangle.
    if (areas[i] > 0.0) thin[i] = tree.first_hit((a + b + c) / 3.0, -area / areas[i], 1e-6 * thickness);
  });
  // Sum the area that is too thin, and find the smallest thickness.
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
  if (too_thin <= kMaxThinFraction * all) return;
  const auto [a, b, c] = surface.corners(surface.triangles()[where]);
  const Vec3 position = (a + b + c) / 3.0;
  refuse("the mesh is thinner than its grid: ", std::round(100.0 * too_thin / all),
         " % of its surface is less than two spacings (", thickness, " m) thick; the smallest thickness is ", thinnest,
         " m at [", coordinates(position), "] m; set the nodes at most ", 0.5 * thinnest,
         " m apart, or take a thicker mesh");
}

}  // namespace

SupportTable::SupportTable(std::vector<Vec3> points) : points_(std::move(points)), cells_(kCells) {
  tie_ = kTie * box_of(points_).size().norm();
  parallel_for(std::size_t{0}, kCells, [&](std::size_t i) { cells_[i] = support_candidates(points_, i, 2.0 * tie_); });
}

double SupportTable::support(const Vec3& direction) const noexcept {
  double largest = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : cells_[cell_of(direction)]) largest = std::max(largest, direction.dot(points_[i]));
  return largest;
}

Vec3 SupportTable::foremost(const Vec3& direction, const Vec3& near) const noexcept {
  const std::vector<std::uint32_t>& candidates = cells_[cell_of(direction)];
  const double threshold = support(direction) - tie_;
  // Find the extreme point closest to `near`.
  const Vec3* nearest = nullptr;
  double distance2 = std::numeric_limits<double>::infinity();
  for (const std::uint32_t i : candidates) {
    if (direction.dot(points_[i]) < threshold) continue;
    const double d2 = (points_[i] - near).squaredNorm();
    if (nearest == nullptr || d2 < distance2) {
      nearest = &points_[i];
      distance2 = d2;
    }
  }
  if (nearest == nullptr) return points_.front();  // only if the direction is not finite
  // Move the point towards each other extreme point until it is closest to `near`. The result is a convex combination
  // of extreme points and therefore extreme as well. If the extreme points span a face, one pass is not enough; two
  // passes come close to the closest point.
  Vec3 support = *nearest;
  for (int pass = 0; pass < 2; ++pass) {
    for (const std::uint32_t i : candidates) {
      if (direction.dot(points_[i]) < threshold) continue;
      const Vec3 line = points_[i] - support;
      const double length2 = line.squaredNorm();
      if (length2 > 0.0) support += std::clamp((near - support).dot(line) / length2, 0.0, 1.0) * line;
    }
  }
  return support;
}

SignedDistanceGrid::SignedDistanceGrid(const ClosedSurface& surface, double spacing)
    : nodes_(nodes_around(surface, spacing)),
      box_{surface.box().min - Vec3::Constant(error_bound()), surface.box().max + Vec3::Constant(error_bound())},
      reach_(std::ranges::max(surface.vertices(), {}, [](const Vec3& v) { return v.squaredNorm(); }).norm() +
             error_bound()),
      vertices_(surface.vertices()),
      hull_(corners_of(surface)) {
  const TriangleTree tree(surface.vertices(), surface.triangles());
  check_thickness(surface, tree, 2.0 * spacing);
  fill(surface, tree);
  classify();
  find_faces(surface);
}

double SignedDistanceGrid::suggested_spacing(std::span<const Vec3> vertices) {
  return suggested_for(box_of(vertices).size());
}

void SignedDistanceGrid::fill(const ClosedSurface& surface, const TriangleTree& tree) {
  // Compute the winding numbers, which give the sign of the distance.
  const std::vector<std::int8_t> numbers = winding_numbers(surface, nodes_);
  check_winding(numbers, nodes_);
  // Allocate one more number, because the SIMD loops read a row of three nodes as four numbers.
  values_.assign(nodes_.size() + 1, 0.0);
  // Compute the distances column by column, eight nodes at a time.
  parallel_for(std::size_t{0}, nodes_.count[0] * nodes_.count[1], [&](std::size_t column) {
    alignas(64) std::array<double, simd::lanes> x, y, z, distances2;
    x.fill(nodes_.coordinate(0, column / nodes_.count[1]));
    y.fill(nodes_.coordinate(1, column % nodes_.count[1]));
    double last = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < nodes_.count[2]; k += simd::lanes) {
      for (std::size_t n = 0; n < simd::lanes; ++n) {
        z[n] = nodes_.coordinate(2, k + n);
        // From one node to another, the distance to the mesh grows by at most the distance between the two nodes.
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
  if (!(half_width_ > 0.0))
    refuse("the mesh is so thin that no node of its grid is inside; set the nodes less than ", nodes_.spacing,
           " m apart");
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one loop over the nodes and their neighbours.
void SignedDistanceGrid::classify() {
  // Nodes on the border of the grid stay `outside`, because the body is at least kMarginNodes away.
  kinds_.assign(nodes_.size(), outside);
  // NOLINTNEXTLINE(readability-function-cognitive-complexity): nested loops over the axes.
  parallel_for(std::size_t{1}, nodes_.count[0] - 1, [&](std::size_t i) {
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

/// Determines whether the body is convex. Finds the largest flat faces of a convex body.
void SignedDistanceGrid::find_faces(const ClosedSurface& surface) {
  const double tolerance = kConvexWithin * nodes_.spacing;
  // Sum the area vectors of the triangles with the same normal, which lie in the same plane if the body is convex.
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
  // Keep the faces with at least the area half_width_^2, in order of decreasing area.
  std::vector<Vec3> largest;
  for (const auto& [normal, area] : areas) {
    if (area.norm() >= half_width_ * half_width_) largest.push_back(area);
  }
  std::stable_sort(largest.begin(), largest.end(),
                   [](const Vec3& a, const Vec3& b) { return a.squaredNorm() > b.squaredNorm(); });
  largest.resize(std::min(largest.size(), kMaxFaces));
  for (const Vec3& area : largest) faces_.push_back({area.normalized(), hull_.support(area.normalized())});
}

}  // namespace hapbench
