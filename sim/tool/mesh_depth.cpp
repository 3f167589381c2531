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
/// A bracket of some spacings shrinks to rounding in less than ten rounds of regula falsi.
constexpr int kMostRounds = 40;

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
    if (!simd::any(out2_ > Pack(0.0))) return;
    for (double& out : out_) out = frame.spacing * std::sqrt(out);
  }

  Pack out2_;
  alignas(64) double out_[simd::lanes];  ///< how far beyond the grid the points lie [m]
  NearestNodes nearest_;
  GridSpline spline_;
};

/// The search of where a ray leaves the body, one value of the field after the other.
class ExitSearch {
 public:
  ExitSearch() = default;
  explicit ExitSearch(const SignedDistanceGrid& grid)
      : shortest_(kShortestWay * grid.spacing()), bound_(grid.error_bound()), furthest_(2.0 * grid.reach()) {}

  bool done() const { return done_; }
  /// The last place in the body.
  double exit() const { return inside_; }

  /// Where along the ray the field is wanted next.
  double next() const {
    if (bracketed_) return std::clamp(inside_ + (outside_ - inside_) * (below_ / (below_ - above_)), inside_, outside_);
    return inside_ + std::max({shortest_, -below_ / std::numbers::sqrt3, -below_ - 2.0 * bound_});
  }

  /// Its value there.
  void take(double place, double value) {
    if (!bracketed_) return walk(place, value);
    // The Illinois rule: an end that stays counts for half.
    if (value <= 0.0) {
      inside_ = place;
      below_ = value;
      if (last_ < 0) above_ *= 0.5;
      last_ = -1;
    } else {
      outside_ = place;
      above_ = value;
      if (last_ > 0) below_ *= 0.5;
      last_ = 1;
    }
    done_ = value == 0.0 || ++rounds_ == kMostRounds || outside_ - inside_ <= 1e-12 * shortest_;
  }

 private:
  void walk(double place, double value) {
    bracketed_ = value > 0.0;
    if (bracketed_) {
      outside_ = place;
      above_ = value;
      // On the surface.
      done_ = below_ == 0.0;
    } else {
      inside_ = place;
      below_ = value;
      if (!(place <= furthest_)) fail();
    }
  }
  /// The direction is none.
  void fail() {
    inside_ = 0.0;
    done_ = true;
  }

  double shortest_ = 0.0, bound_ = 0.0, furthest_ = 0.0;
  double inside_ = 0.0, below_ = 0.0, outside_ = 0.0, above_ = 0.0;
  int last_ = 0, rounds_ = 0;
  bool bracketed_ = false, done_ = false;
};

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

/// Eight rays side by side, which share the weights' arithmetic.
void MeshTool::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const std::size_t rays = std::min(contacts.size() - i, simd::lanes);
    std::array<ExitSearch, simd::lanes> searches;
    searches.fill(ExitSearch(*grid_));
    std::array<double, simd::lanes> places{};
    // From the contacts themselves on.
    for (bool first = true, busy = true; busy; first = false) {
      alignas(64) double x[simd::lanes] = {}, y[simd::lanes] = {}, z[simd::lanes] = {};
      busy = false;
      for (std::size_t k = 0; k < rays; ++k) {
        if (searches[k].done()) continue;
        busy = true;
        places[k] = first ? 0.0 : searches[k].next();
        x[k] = contacts.x[i + k] + places[k] * contacts.ux[i + k];
        y[k] = contacts.y[i + k] + places[k] * contacts.uy[i + k];
        z[k] = contacts.z[i + k] + places[k] * contacts.uz[i + k];
      }
      if (!busy) break;
      const FieldPack field(*grid_, frame, x, y, z);
      for (std::size_t k = 0; k < rays; ++k) {
        if (searches[k].done()) continue;
        // Contacts lie in the body, if only up to rounding.
        const double value = field.value(k);
        searches[k].take(places[k], first && value > 0.0 ? 0.0 : value);
      }
    }
    for (std::size_t k = 0; k < rays; ++k) exits[i + k] = searches[k].exit();
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
