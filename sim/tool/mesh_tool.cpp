#include "sim/tool/mesh_tool.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/contact/push_hits.hpp"
#include "sim/core/math.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/grid_spline.hpp"

namespace hapbench {
namespace {

using simd::Pack;

/// Number of times that box_near shrinks its box; further passes hardly shrink it.
constexpr int kShrinks = 3;

/// Calls `use` with the number of each bit that is set.
template <class Use>
void for_each_bit(std::uint8_t bits, const Use& use) {
  for (unsigned rest = bits; rest != 0; rest &= rest - 1) use(static_cast<std::size_t>(std::countr_zero(rest)));
}

/// Tests which of eight points lie in the body.
std::uint8_t inside_bits(const SignedDistanceGrid& grid, const GridFrame& frame, const double* x, const double* y,
                         const double* z) {
  const GridPack q(frame, x, y, z);
  if (!simd::any(q.within)) return 0;
  const NearestNodes nearest(frame, q);
  unsigned inside = 0, mixed = 0;
  for (std::size_t k = 0; k < simd::lanes; ++k) {
    const unsigned kind = grid.kinds()[nearest[k]];  // `outside` beyond the grid
    inside |= (kind & 1u) << k;
    mixed |= (kind >> 1) << k;
  }
  if (mixed == 0) return static_cast<std::uint8_t>(inside);
  const GridSpline spline(grid, q, nearest);
  for_each_bit(static_cast<std::uint8_t>(mixed),
               [&](std::size_t k) { inside |= (spline.value(k, nearest[k]) <= 0.0 ? 1u : 0u) << k; });
  return static_cast<std::uint8_t>(inside);
}

/// Writes the marks of the packs of all ranges; `test(i)` returns those of the eight points from i on.
template <class Test>
void mark(std::span<const PackRange> ranges, std::uint8_t* marks, const Test& test) {
  for (const PackRange range : ranges) {
    for (std::size_t pack = range.first; pack < range.last; ++pack)
      *marks++ = range.own(test(pack * simd::lanes), pack);
  }
}

Box intersection(const Box& a, const Box& b) {
  return {a.min.cwiseMax(b.min), a.max.cwiseMin(b.max)};
}

/// The box around a box that is turned about the origin and then moved.
Box turned(const Box& box, const Mat3& rotation, const Vec3& position) {
  const Vec3 centre = rotation * (0.5 * (box.min + box.max)) + position;
  const Vec3 half = rotation.cwiseAbs() * (0.5 * (box.max - box.min));
  return {centre - half, centre + half};
}

/// A gradient of the field with respect to the nodes' coordinates that is shorter than this, in spacings, is rounding:
/// the nearest places lie on all sides.
constexpr double kUndefinedBelow = 1e-9;
/// The shortest step along a ray, in spacings.
constexpr double kShortestWay = 0.125;
/// Ten rounds of regula falsi usually shrink a bracket of some spacings to rounding.
constexpr int kMostRounds = 40;

/// The field at eight points anywhere, evaluated one by one.
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
  alignas(64) double out_[simd::lanes];  ///< distance beyond the grid [m]
  NearestNodes nearest_;
  GridSpline spline_;
};

/// Searches for the place where a ray leaves the body; the caller evaluates the field.
class ExitSearch {
 public:
  ExitSearch() = default;
  explicit ExitSearch(const SignedDistanceGrid& grid)
      : shortest_(kShortestWay * grid.spacing()), bound_(grid.error_bound()), furthest_(2.0 * grid.reach()) {}

  bool done() const { return done_; }
  /// The last place in the body.
  double exit() const { return inside_; }

  /// Distance along the ray at which to evaluate the field next.
  double next() const {
    if (bracketed_) return std::clamp(inside_ + (outside_ - inside_) * (below_ / (below_ - above_)), inside_, outside_);
    return inside_ + std::max({shortest_, -below_ / std::numbers::sqrt3, -below_ - 2.0 * bound_});
  }

  /// Takes the field's value there.
  void take(double place, double value) {
    if (!bracketed_) return walk(place, value);
    // The Illinois rule: an end that stays twice counts half.
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
      done_ = below_ == 0.0;  // on the surface
      return;
    }
    inside_ = place;
    below_ = value;
    if (place <= furthest_) return;
    // The direction is zero or not finite.
    inside_ = 0.0;
    done_ = true;
  }

  double shortest_ = 0.0, bound_ = 0.0, furthest_ = 0.0;
  double inside_ = 0.0, below_ = 0.0, outside_ = 0.0, above_ = 0.0;
  int last_ = 0, rounds_ = 0;
  bool bracketed_ = false, done_ = false;
};

/// The gradient as a unit vector of the world; `otherwise` if it is rounding.
Vec3 outwards(const GridFrame& frame, const Vec3& by_nodes, const Vec3& otherwise) {
  const double length = by_nodes.norm();
  if (!(length > kUndefinedBelow * frame.spacing)) return otherwise;
  return (frame.turn.transpose() * by_nodes).normalized();
}

}  // namespace

MeshTool::MeshTool(std::shared_ptr<const SignedDistanceGrid> grid)
    : ToolShape(grid->half_width(), grid->reach()), grid_(std::move(grid)) {}

void MeshTool::mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                           std::uint8_t* marks) const noexcept {
  const GridFrame frame(*grid_, pose);
  mark(ranges, marks,
       [&](std::size_t i) { return inside_bits(*grid_, frame, points.x + i, points.y + i, points.z + i); });
}

void MeshTool::push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                           ContactBuffer& contacts) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (const PackRange range : ranges) {
    for (std::size_t pack = range.first; pack < range.last; ++pack) {
      const std::size_t i = pack * simd::lanes;
      const std::uint8_t hits = range.own(inside_bits(*grid_, frame, points.x + i, points.y + i, points.z + i), pack);
      if (hits != 0) push_hits(hits, points, i, contacts);
    }
  }
}

void MeshTool::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const GridFrame frame(*grid_, pose);
  const Pack slack(2.0 * grid_->error_bound()), margin2(margin * margin), spacing2(frame.spacing * frame.spacing);
  mark(ranges, marks, [&](std::size_t i) {
    GridPack q(frame, points.x + i, points.y + i, points.z + i);
    const Pack out2 = q.clamp(frame);
    const NearestNodes nearest(frame, q);
    alignas(64) double values[simd::lanes];
    for (std::size_t k = 0; k < simd::lanes; ++k) values[k] = grid_->values()[nearest[k]];
    const Pack least = simd::max(simd::load(values) - slack, Pack(0.0));
    return simd::bits(out2 * spacing2 + least * least <= margin2);
  });
}

// Restricts the bounds to what is near the tool's box and the tool's box to what is near that, alternately.
Box MeshTool::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const Mat3 rotation = pose.rotation();
  const Mat3 back = rotation.transpose();
  const Box body{grid_->box().min - Vec3::Constant(margin), grid_->box().max + Vec3::Constant(margin)};
  // Covers the rounding of the rotations.
  const double slack = 1e-12 * (reach() + margin + pose.position.cwiseAbs().maxCoeff());
  Box part = body, near = turned(body, rotation, pose.position);
  for (int k = 0; k < kShrinks; ++k) {
    Box shared = intersection(near, bounds);
    if ((shared.min.array() > shared.max.array()).any()) return {Vec3::Ones(), -Vec3::Ones()};
    shared = {shared.min - Vec3::Constant(slack), shared.max + Vec3::Constant(slack)};
    part = intersection(part, turned(shared, back, -(back * pose.position)));
    if ((part.min.array() > part.max.array()).any()) return {Vec3::Ones(), -Vec3::Ones()};
    near = turned(part, rotation, pose.position);
  }
  return {near.min - Vec3::Constant(slack), near.max + Vec3::Constant(slack)};
}

ToolShape::Cover MeshTool::cover(double margin) const {
  // With a, b and e as in mark_near, the place in the grid nearest to a marked point is within b + 3 e of the mesh, and
  // a + b <= sqrt(2) margin.
  const Vec3 extent = grid_->box().size() + Vec3::Constant(3.0 * margin + 4.0 * grid_->error_bound());
  Eigen::Index longest = 0;
  const double length = extent.maxCoeff(&longest);
  const double across = math::hypot(extent[(longest + 1) % 3], extent[(longest + 2) % 3]);
  const double balls = std::ceil(length / across);
  return {static_cast<std::size_t>(balls), (1.0 + 1e-9) * 0.5 * math::hypot(across, length / balls)};
}

double MeshTool::moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept {
  const double moved = (to.position - from.position).norm();
  // Most steps of most scenes do not turn the tool.
  if (to.axis == from.axis && to.roll == from.roll) return moved;
  return moved + (to.rotation() - from.rotation()).norm() / std::numbers::sqrt2 * reach();
}

std::vector<ProfilePoint> MeshTool::outline() const {
  const GridNodes& nodes = grid_->nodes();
  std::vector<double> widest(nodes.count[2], -1.0);
  for (std::size_t i = 0; i < nodes.count[0]; ++i) {
    for (std::size_t j = 0; j < nodes.count[1]; ++j) {
      for (std::size_t k = 0; k < nodes.count[2]; ++k) {
        const double depth = -grid_->values()[nodes.index(i, j, k)];
        if (depth < 0.0) continue;
        widest[k] = std::max(widest[k], math::hypot(nodes.coordinate(0, i), nodes.coordinate(1, j)) + depth);
      }
    }
  }
  // The far end is the body's highest place in its own frame.
  std::vector<ProfilePoint> outline = {{-grid_->box().max.z(), 0.0}};
  for (std::size_t k = nodes.count[2]; k-- > 0;) {
    if (widest[k] >= 0.0) outline.push_back({-nodes.coordinate(2, k), widest[k]});
  }
  outline.push_back({-grid_->box().min.z(), 0.0});
  return outline;
}

ToolShape::Grown MeshTool::grown(double margin) const {
  const double e = grid_->error_bound();
  double radius2 = 0.0;
  for (const Vec3& v : grid_->vertices()) radius2 = std::max(radius2, v.head<2>().squaredNorm());
  const double forward = -grid_->box().min.z() + margin;
  const double radius = std::max(std::sqrt(radius2) + e + margin, 1e-9 * reach());
  return {std::make_unique<Cylinder>(radius, grid_->box().size().z() + 2.0 * margin, Tip::flat), forward};
}

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

// Marches along eight rays at once, which share the computation of the weights.
void MeshTool::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const std::size_t rays = std::min(contacts.size() - i, simd::lanes);
    std::array<ExitSearch, simd::lanes> searches;
    searches.fill(ExitSearch(*grid_));
    std::array<double, simd::lanes> places{};
    // The first pass evaluates the field at the contacts.
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
        // Contacts lie in the body up to rounding.
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
