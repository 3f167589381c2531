#include "sim/geometry/solid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/tool/closed_surface.hpp"

namespace hapbench {
namespace {

constexpr double kFar = 1e4;  ///< longer than any distance in a scene [m]

/// Returns an upper bound of the distance of point q from the surface [m], computed from the distance known at a nearby
/// point. The relative margin covers rounding. The absolute margin covers rounding for points on the surface.
double largest_distance(const Vec3& q, const KnownDistance& near) {
  constexpr double kRelative = 1e-9, kAbsolute = 1e-12;
  return (1.0 + kRelative) * (std::abs(near.value) + (q - near.point).norm()) + kAbsolute;
}

/// Solid in closed form: one of the shapes of analytic_shells.hpp.
template <class Shape>
class ShapeSolid final : public Solid {
 public:
  ShapeSolid(const Shape& shape, const Box& region) : Solid(region), shape_(shape) {}
  SurfaceDistance at(const Vec3& q, const KnownDistance*) const noexcept override {
    return {signed_distance(shape_, q), is_known(q)};
  }
  double max_depth_in(const Box& box) const noexcept override {
    if constexpr (std::is_same_v<Shape, Slot>)
      return std::max(-box.min.x(), box.max.x()) - shape_.gap / 2;
    else if constexpr (std::is_same_v<Shape, ConicalHole>)
      return Solid::max_depth_in(box);
    else  // otherwise: the depth below the flat top
      return -(std::is_same_v<Shape, Hole2d> ? box.min.y() : box.min.z());
  }

 private:
  bool is_known(const Vec3& q) const noexcept {
    if constexpr (std::is_same_v<Shape, BlockWithHole>) return true;
    if constexpr (std::is_same_v<Shape, ConicalHole>)
      return q.head<2>().norm() <= shape_.depth * math::tan(shape_.half_angle);
    const Vec3 low = region().min, high = region().max;
    return q.x() >= low.x() && q.x() <= high.x() && q.y() >= low.y() && q.y() <= high.y() && q.z() >= low.z() &&
           (!std::is_same_v<Shape, Slot> || q.z() <= high.z());
  }

  Shape shape_;
};

/// Solid bounded by a triangle mesh.
class MeshSolid final : public Solid {
 public:
  MeshSolid(TriangleSoup surface, bool is_closed)
      : Solid(box_of(surface.vertices)), surface_(std::move(surface)), tree_(surface_.vertices, surface_.triangles) {
    if (is_closed) return;
    // The mesh is closed if equally many triangles run along each edge in both directions.
    const std::vector<TriangleSide> sides = sides_by_edge(surface_.triangles);
    for_each_edge(sides, [this](std::span<const TriangleSide> edge) { closed_ = closed_ && is_balanced(edge); });
    if (closed_) return;
    set_region({Vec3::Constant(-kFar), Vec3::Constant(kFar)});
    find_borders(sides);
  }

  SurfaceDistance at(const Vec3& q, const KnownDistance* near) const noexcept override {
    const auto nearest = nearest_triangle(q, near);
    return nearest ? signed_distance(q, *nearest, near) : SurfaceDistance{kFar, false};  // only if q is not finite
  }
  Vec3 gradient(const Vec3& q, double step, const KnownDistance* near) const noexcept override {
    const auto nearest = nearest_triangle(q, near);
    if (!nearest) return Vec3::UnitZ();
    const Vec3 away = q - nearest->position, n = normal(nearest->triangle);
    // At less than 1e-6 times `step` from the surface, rounding dominates the direction from the closest point.
    if (away.norm() < 1e-6 * step) return n;
    return away.normalized() * (signed_distance(q, *nearest, near).value < 0.0 ? -1.0 : 1.0);
  }
  std::size_t bytes() const noexcept override { return 300 * surface_.triangles.size(); }

 private:
  /// Returns the signed distance of a point whose closest triangle is known.
  SurfaceDistance signed_distance(const Vec3& q, const TriangleTree::Nearest& nearest,
                                  const KnownDistance* near) const noexcept {
    const double distance = std::sqrt(nearest.distance2);
    if (closed_) {
      // Closed mesh: the sign follows from a known distance nearby, or from the winding number.
      if (near != nullptr && (q - near->point).norm() < std::abs(near->value))
        return {std::copysign(distance, near->value)};
      const bool out = beyond(q) || tree_.winding_number(q, surface_.vertices, surface_.triangles) <= 0;
      return {out ? distance : -distance};
    }
    // Open mesh: phi is positive on the side to which the normal at the closest point points.
    const auto [n, is_border] = feature(nearest);
    return {std::copysign(distance, (q - nearest.position).dot(n)), !is_border};
  }
  const Vec3& vertex(std::size_t triangle, std::size_t corner) const {
    return surface_.vertices[surface_.triangles[triangle][corner]];
  }
  Vec3 normal(std::size_t t) const {
    return (vertex(t, 1) - vertex(t, 0)).cross(vertex(t, 2) - vertex(t, 0)).stableNormalized();
  }
  std::optional<TriangleTree::Nearest> nearest_triangle(const Vec3& q, const KnownDistance* near) const {
    return tree_.nearest(q, near == nullptr ? kFar : largest_distance(q, *near));
  }
  bool beyond(const Vec3& q) const {
    return (q.array() < region().min.array()).any() || (q.array() > region().max.array()).any();
  }

  /// Finds the border (edges with one triangle only) and the normals of all edges and vertices.
  void find_borders(std::span<const TriangleSide> sides) {
    vertex_normals_.assign(surface_.vertices.size(), Vec3::Zero());
    border_vertices_.assign(surface_.vertices.size(), false);
    edge_normals_.resize(surface_.triangles.size());
    at_border_.assign(surface_.triangles.size(), 0);
    for_each_edge(sides, [this](std::span<const TriangleSide> edge) {
      Vec3 n = Vec3::Zero();
      for (const TriangleSide& side : edge) n += normal(side.triangle);
      for (const TriangleSide& side : edge) edge_normals_[side.triangle][side.corner] = n;
      if (edge.size() > 1) return;
      at_border_[edge[0].triangle] |= static_cast<std::uint8_t>(1u << edge[0].corner);
      border_vertices_[edge[0].low] = border_vertices_[edge[0].high] = true;
    });
    // The normal of a vertex is the sum of its triangles' normals, weighted by their angles at the vertex.
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = vertex(t, k), b = vertex(t, (k + 1) % 3), c = vertex(t, (k + 2) % 3);
        const double angle = math::atan2((b - a).cross(c - a).norm(), (b - a).dot(c - a));
        vertex_normals_[surface_.triangles[t][k]] += angle * normal(t);
      }
    }
  }

  struct Feature {
    Vec3 normal;  ///< not normalised
    bool is_border;
  };
  /// Returns the normal of the face, edge or vertex on which the closest point lies. A query point is outside
  /// if it lies on the side to which this normal points. This test needs a vertex normal that is the mean of the face
  /// normals weighted by angles (J. A. Baerentzen and H. Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 2005).
  Feature feature(const TriangleTree::Nearest& nearest) const {
    const std::size_t t = nearest.triangle;
    if (nearest.corners == 7u) return {normal(t), false};
    if (nearest.corners == 3u) return edge(t, 0);
    if (nearest.corners == 6u) return edge(t, 1);
    if (nearest.corners == 5u) return edge(t, 2);
    const std::uint32_t v = surface_.triangles[t][nearest.corners >> 1u];
    return {vertex_normals_[v], border_vertices_[v]};
  }
  Feature edge(std::size_t t, std::size_t k) const {
    return {edge_normals_[t][k], ((unsigned{at_border_[t]} >> k) & 1u) != 0};
  }

  TriangleSoup surface_;
  TriangleTree tree_;
  bool closed_ = true;
  // Filled for an open mesh only:
  std::vector<Vec3> vertex_normals_;
  std::vector<bool> border_vertices_;
  std::vector<std::uint8_t> at_border_;            ///< [t]: bit k is set if the edge from corner k is on the border
  std::vector<std::array<Vec3, 3>> edge_normals_;  ///< [t][k]: sum of normals at the edge from corner k of triangle t
};

/// Solid given by points with normals.
class PointSolid final : public Solid {
 public:
  explicit PointSolid(const std::vector<SurfacePoint>& points)
      : Solid({Vec3::Constant(-kFar), Vec3::Constant(kFar)}),
        points_(points),
        tree_(tree_of(points)),
        spacing_(2.0 * median_spacing()) {}

  SurfaceDistance at(const Vec3& q, const KnownDistance* near) const noexcept override {
    // |phi| is at most spacing_ smaller than the distance to the closest point.
    const auto nearest = tree_.nearest(q, near == nullptr ? kFar : largest_distance(q, *near) + spacing_);
    if (!nearest) return {kFar, false};  // only if q is not finite
    // Split q - p into the height h along the normal and the tangential part.
    const auto& [p, n] = points_[nearest->triangle];
    const double h = n.dot(q - p);
    const Vec3 along = q - p - h * n;
    const double tangential = along.norm(), beyond = std::max(0.0, tangential * tangential - spacing_ * spacing_);
    // If the tangential distance exceeds the spacing, phi is known only if the shell continues in the tangential
    // direction: a shell point lies near the position that is 2 spacing_ away from p in this direction.
    const bool continues =
        beyond == 0.0 || tree_.nearest(p + 2.0 * spacing_ / tangential * along, 1.5 * spacing_).has_value();
    return {std::copysign(std::sqrt(h * h + beyond), h), continues};
  }
  double error() const noexcept override { return 0.5 * spacing_; }
  std::size_t bytes() const noexcept override { return 300 * points_.size(); }

 private:
  static TriangleTree tree_of(const std::vector<SurfacePoint>& points) {
    TriangleSoup soup;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      soup.vertices.push_back(points[i].position);
      soup.triangles.push_back({i, i, i});
    }
    return {soup.vertices, soup.triangles};
  }
  /// Returns the median distance between a sample of points and their nearest neighbours [m].
  double median_spacing() const {
    constexpr std::size_t kSamples = 32;
    std::vector<double> distances;
    for (std::size_t i = 0; i < points_.size(); i += points_.size() / kSamples + 1) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < points_.size(); ++j) {
        const double d = (points_[j].position - points_[i].position).squaredNorm();
        if (d > 0.0) nearest = std::min(nearest, d);
      }
      if (std::isfinite(nearest)) distances.push_back(std::sqrt(nearest));
    }
    if (distances.empty()) return 0.0;
    std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2),
                     distances.end());
    return distances[distances.size() / 2];
  }

  std::vector<SurfacePoint> points_;
  TriangleTree tree_;
  double spacing_;
};

}  // namespace

Vec3 Solid::gradient(const Vec3& point, double step, const KnownDistance* near) const noexcept {
  Vec3 gradient;
  for (int k = 0; k < 3; ++k) {
    const Vec3 offset = step * Vec3::Unit(k);
    gradient[k] = at(point + offset, near).value - at(point - offset, near).value;
  }
  return unit_or(gradient, Vec3::UnitZ());
}

std::unique_ptr<const Solid> make_solid(const Plane& plane) {
  const double half = plane.size / 2;
  return std::make_unique<ShapeSolid<Plane>>(plane, Box{{-half, -half, -kFar}, {half, half, 0.0}});
}

std::unique_ptr<const Solid> make_solid(const Slot& slot) {
  const double half = slot.length / 2;
  return std::make_unique<ShapeSolid<Slot>>(slot, Box{{-kFar, -half, -slot.depth}, {kFar, half, 0.0}});
}

std::unique_ptr<const Solid> make_solid(const Hole2d& hole) {
  const double half = hole.width / 2 + hole.mouth;
  return std::make_unique<ShapeSolid<Hole2d>>(hole, Box{{-half, -kFar, -kFar}, {half, kFar, kFar}});
}

std::unique_ptr<const Solid> make_solid(const ConicalHole& cone) {
  const double radius = cone.depth * math::tan(cone.half_angle);
  return std::make_unique<ShapeSolid<ConicalHole>>(cone, Box{{-radius, -radius, -kFar}, {radius, radius, 0.0}});
}

std::unique_ptr<const Solid> make_solid(const BlockWithHole& block) {
  const Vec3 half = block.size / 2;
  return std::make_unique<ShapeSolid<BlockWithHole>>(
      block, Box{{-half.x(), -half.y(), -block.size.z()}, {half.x(), half.y(), 0.0}});
}

std::unique_ptr<const Solid> make_solid(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles,
                                        bool is_closed) {
  if (!is_closed) return std::make_unique<MeshSolid>(welded(vertices, triangles), false);
  TriangleSoup surface;
  surface.vertices.assign(vertices.begin(), vertices.end());
  surface.triangles.assign(triangles.begin(), triangles.end());
  return std::make_unique<MeshSolid>(std::move(surface), true);
}

std::unique_ptr<const Solid> make_solid(const std::vector<SurfacePoint>& points) {
  return std::make_unique<PointSolid>(points);
}

}  // namespace hapbench
