#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/tool/grid_spline.hpp"
#include "sim/tool/mesh_tool.hpp"

/// What depth models and the proxy ask of a mesh.
namespace hapbench {
namespace {

using simd::Pack;

/// A gradient of the field, by the coordinates of the nodes, shorter than this share of the spacing is rounding: where
/// the nearest places lie on all sides.
constexpr double kUndefinedBelow = 1e-9;
/// The shortest way along a ray, in spacings.
constexpr double kShortestWay = 0.125;
/// A bracket of an eighth of a spacing shrinks to rounding in less than ten rounds of regula falsi.
constexpr int kMostRounds = 40;
/// Cosine of the angle up to which a face of the tool counts as flush with a surface (see cylinder_constraints.cpp).
constexpr double kFlush = 0.9945;

/// The field at eight points anywhere, one after the other.
class FieldPack {
 public:
  FieldPack(const SignedDistanceGrid& grid, const GridFrame& frame, const double* x, const double* y, const double* z)
      : FieldPack(grid, frame, GridPack(frame, x, y, z)) {}

  double value(std::size_t lane) const { return out_[lane] + spline_.value(lane, nearest_[lane]); }
  FieldValue value_and_gradient(std::size_t lane) const {
    FieldValue field = spline_.value_and_gradient(lane, nearest_[lane]);
    field.value += out_[lane];
    return field;
  }

 private:
  FieldPack(const SignedDistanceGrid& grid, const GridFrame& frame, GridPack q)
      : out2_(q.clamp(frame)), nearest_(frame, q), spline_(grid, q, nearest_) {
    simd::store(out2_, out_);
    for (double& out : out_) out = frame.spacing * std::sqrt(out);
  }

  Pack out2_;
  alignas(64) double out_[simd::lanes];  ///< how far beyond the grid the points lie [m]
  NearestNodes nearest_;
  GridSpline spline_;
};

/// The field along one ray, in the frame of the nodes.
class FieldAlongRay {
 public:
  FieldAlongRay(const SignedDistanceGrid& grid, const GridFrame& frame, const Vec3& point, const Vec3& direction)
      : grid_(grid), frame_(frame), point_(point), direction_(direction) {}

  double operator()(double distance) const {
    const Vec3 place = point_ + distance * direction_;
    alignas(64) double x[simd::lanes], y[simd::lanes], z[simd::lanes];
    std::fill_n(x, simd::lanes, place.x());
    std::fill_n(y, simd::lanes, place.y());
    std::fill_n(z, simd::lanes, place.z());
    return FieldPack(grid_, frame_, x, y, z).value(0);
  }

 private:
  const SignedDistanceGrid& grid_;
  const GridFrame& frame_;
  Vec3 point_, direction_;
};

/// Where the field changes its sign between `inside`, of value below <= 0, and `outside`, of value above > 0 (Illinois
/// rule: an end that stays counts for half).
double root(const FieldAlongRay& field, double inside, double below, double outside, double above) {
  const double enough = 1e-12 * (outside - inside);
  int side = 0;
  for (int k = 0; k < kMostRounds && outside - inside > enough; ++k) {
    const double middle = std::clamp(inside + (outside - inside) * (below / (below - above)), inside, outside);
    const double value = field(middle);
    if (value == 0.0) return middle;
    if (value < 0.0) {
      inside = middle;
      below = value;
      if (side == -1) above *= 0.5;
      side = -1;
    } else {
      outside = middle;
      above = value;
      if (side == 1) below *= 0.5;
      side = 1;
    }
  }
  return inside;
}

double exit_distance(const SignedDistanceGrid& grid, const GridFrame& frame, const Vec3& point, const Vec3& direction) {
  const FieldAlongRay field(grid, frame, point, direction);
  const double shortest = kShortestWay * frame.spacing, furthest = 2.0 * grid.reach();
  double inside = 0.0, value = field(0.0);
  // Up to rounding, contacts lie in the body; those on its surface may start outwards.
  if (value > 0.0) value = 0.0;
  while (inside <= furthest) {
    const double next = inside + std::max({shortest, -value / std::numbers::sqrt3, -value - 2.0 * grid.error_bound()});
    const double there = field(next);
    if (there > 0.0) return root(field, inside, value, next, there);
    inside = next;
    value = there;
  }
  return 0.0;  // the direction is none
}

/// The gradient as a unit vector of the world.
Vec3 outwards(const GridFrame& frame, const Vec3& by_nodes, const Vec3& otherwise) {
  const double length = by_nodes.norm();
  if (!(length > kUndefinedBelow * frame.spacing)) return otherwise;
  return (frame.turn.transpose() * by_nodes).normalized();
}

}  // namespace

void MeshTool::shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const FieldPack field(*grid_, frame, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    const std::size_t end = std::min(contacts.size() - i, simd::lanes);
    for (std::size_t k = 0; k < end; ++k) contacts.depth[i + k] = -field.value(k);
  }
}

void MeshTool::shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const FieldPack field(*grid_, frame, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    for (std::size_t k = i; k < std::min(contacts.size(), i + simd::lanes); ++k) {
      contacts.set_gradient(k, outwards(frame, field.value_and_gradient(k - i).gradient, -contacts.normal(k)));
    }
  }
}

void MeshTool::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    exits[i] = exit_distance(*grid_, frame, contacts.point(i), contacts.gradient(i));
  }
}

void MeshTool::surface_constraints(const ToolPose& pose, const Vec3& wanted, double slack,
                                   ContactBuffer& contacts) const noexcept {
  const GridFrame frame(*grid_, pose);
  const Mat3 rotation = pose.rotation();
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const FieldPack field(*grid_, frame, &contacts.x[i], &contacts.y[i], &contacts.z[i]);
    for (std::size_t k = i; k < std::min(contacts.size(), i + simd::lanes); ++k) {
      const auto [value, gradient] = field.value_and_gradient(k - i);
      const Vec3 normal = contacts.normal(k);
      Vec3 m = outwards(frame, gradient, -normal);
      contacts.depth[k] = -value;
      if (grid_->convex()) {
        const Vec3 x = rotation.transpose() * (contacts.point(k) - pose.position);
        const Vec3 local = rotation.transpose() * m;
        contacts.depth[k] = grid_->hull().support(local) - local.dot(x);
        if (m.dot(wanted) > -contacts.depth[k]) {
          const Vec3 back = rotation.transpose() * -normal;
          double most = kFlush;
          for (const SignedDistanceGrid::Face& face : grid_->flat_faces()) {
            const double flush = face.normal.dot(back), depth = face.offset - face.normal.dot(x);
            if (flush <= most || depth > slack) continue;
            most = flush;
            contacts.depth[k] = depth;
            m = rotation * face.normal;
          }
        }
      }
      contacts.set_gradient(k, m);
    }
  }
  contacts.pad();
}

void MeshTool::foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                               const PlaceArrays& places) const noexcept {
  const Mat3 rotation = pose.rotation();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 abreast = rotation.transpose() * (contacts.point(i) - pose.position);
    const Vec3 place =
        pose.position + rotation * grid_->hull().foremost(rotation.transpose() * -contacts.normal(i), abreast);
    places.x[i] = place.x();
    places.y[i] = place.y();
    places.z[i] = place.z();
  }
}

}  // namespace hapbench
