#include "sim/tool/mesh_tool.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/core/simd.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {
namespace {

using simd::Mask, simd::Pack;

/// Transformation from the world frame to the coordinates u of a grid's nodes for one pose: u = turn (x - position)
/// + shift. u = (i, j, k) is node (i, j, k).
struct GridFrame {
  Mat3 turn;
  Vec3 position, shift;
  Vec3 last;  ///< largest coordinates of the grid; the smallest are 1, so that the nearest node has all 26 neighbours
  double spacing;
  double row, layer;  ///< index differences between neighbours along y and along x

  GridFrame(const SignedDistanceGrid& grid, const ToolPose& pose)
      : turn(pose.rotation().transpose() / grid.nodes().spacing),
        position(pose.position),
        shift(-grid.nodes().origin / grid.nodes().spacing),
        spacing(grid.nodes().spacing),
        row(static_cast<double>(grid.nodes().count[2])),
        layer(static_cast<double>(grid.nodes().count[1] * grid.nodes().count[2])) {
    for (int k = 0; k < 3; ++k) last[k] = static_cast<double>(grid.nodes().count[static_cast<std::size_t>(k)]) - 2.0;
  }
};

/// Eight points in the coordinates of the nodes. Always inline: g++ would otherwise store the packs in memory.
struct GridPack {
  Pack u, v, w;
  Mask within;  ///< set if the point is in the grid; not set if coordinates are not finite

  [[gnu::always_inline]] GridPack(const GridFrame& f, const double* px, const double* py, const double* pz) {
    const Pack x = simd::load(px) - Pack(f.position.x()), y = simd::load(py) - Pack(f.position.y()),
               z = simd::load(pz) - Pack(f.position.z());
    const auto along = [&](int k) {
      return Pack(f.turn(k, 0)) * x + Pack(f.turn(k, 1)) * y + Pack(f.turn(k, 2)) * z + Pack(f.shift[k]);
    };
    u = along(0);
    v = along(1);
    w = along(2);
    const Pack one(1.0);
    within =
        u >= one && u <= Pack(f.last.x()) && v >= one && v <= Pack(f.last.y()) && w >= one && w <= Pack(f.last.z());
  }

  /// Moves each point to the closest point of the grid. Coordinates that are NaN become 1, the smallest coordinate.
  /// Returns the squared displacements [spacings^2].
  Pack clamp(const GridFrame& f) {
    Pack out2(0.0);
    const auto clamp_one = [&out2](Pack& coordinate, double last) {
      const Pack to = simd::select(coordinate > Pack(1.0), simd::min(coordinate, Pack(last)), Pack(1.0));
      out2 = out2 + (coordinate - to) * (coordinate - to);
      coordinate = to;
    };
    clamp_one(u, f.last.x());
    clamp_one(v, f.last.y());
    clamp_one(w, f.last.z());
    within = u >= Pack(1.0);
    return out2;
  }
};

/// Returns the nearest integer, halves rounded to even: after adding 1.5 * 2^52, no bit for a fraction remains.
/// Precondition: 0 <= a <= 2^51.
Pack nearest_whole(const Pack& a) {
  const Pack big(0x1.8p52);
  return (a + big) - big;
}

/// Indices of the nodes nearest to eight points. A point outside of the grid (GridPack::within) gets the first node.
struct NearestNodes {
  Pack i, j, k;

  NearestNodes(const GridFrame& f, const GridPack& q)
      : i(nearest_whole(q.u)), j(nearest_whole(q.v)), k(nearest_whole(q.w)) {
    const Pack number = i * Pack(f.layer) + j * Pack(f.row) + k;
    // The low bits of a double above 2^52 are the integer itself, which avoids a conversion.
    simd::store(simd::select(q.within, number, Pack(0.0)) + Pack(0x1p52), numbers_);
  }
  std::size_t operator[](std::size_t lane) const {
    return static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(numbers_[lane]));
  }

 private:
  alignas(64) double numbers_[simd::lanes];
};

struct FieldValue {
  double value;   ///< phi_h [m]
  Vec3 gradient;  ///< gradient with respect to the coordinates of the nodes [m]
};

/// Evaluates the field phi_h (SignedDistanceGrid) at eight points in the grid. The weights are computed for all points
/// at once, the sums point by point. Rows of three nodes are contiguous in memory, so a point needs nine loads of four
/// doubles. A gather instruction would load 27 nodes for each of the eight points.
class GridSpline {
 public:
  GridSpline(const SignedDistanceGrid& grid, const GridPack& q, const NearestNodes& nearest)
      : values_(grid.values()), row_(grid.nodes().count[2]), layer_(grid.nodes().count[1] * row_) {
    const Pack t[] = {q.u - nearest.i, q.v - nearest.j, q.w - nearest.k}, half(0.5);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Pack below = half - t[axis], above = half + t[axis];
      simd::store(half * below * below, weights_[axis][0]);
      simd::store(Pack(0.75) - t[axis] * t[axis], weights_[axis][1]);
      simd::store(half * above * above, weights_[axis][2]);
      simd::store(t[axis], t_[axis]);
    }
  }

  /// Returns phi_h [m] of point number `lane`. `node`: index of the node nearest to the point.
  double value(std::size_t lane, std::size_t node) const {
    const double* const corner = values_ + node - layer_ - row_ - 1;
    Four sum = {};
    for (std::size_t a = 0; a < 3; ++a) {
      Four layer = {};
      for (std::size_t b = 0; b < 3; ++b) {
        Four row;
        std::memcpy(&row, corner + a * layer_ + b * row_, sizeof(row));
        layer += weights_[1][b][lane] * row;
      }
      sum += weights_[0][a][lane] * layer;
    }
    return along_row(lane, sum);
  }

  FieldValue value_and_gradient(std::size_t lane, std::size_t node) const {
    const double x = t_[0][lane], y = t_[1][lane], z = t_[2][lane];
    const double slopes_x[] = {x - 0.5, -2.0 * x, x + 0.5}, slopes_y[] = {y - 0.5, -2.0 * y, y + 0.5};
    const double* const corner = values_ + node - layer_ - row_ - 1;
    Four sum = {}, by_x = {}, by_y = {};
    for (std::size_t a = 0; a < 3; ++a) {
      Four layer = {}, slope = {};
      for (std::size_t b = 0; b < 3; ++b) {
        Four row;
        std::memcpy(&row, corner + a * layer_ + b * row_, sizeof(row));
        layer += weights_[1][b][lane] * row;
        slope += slopes_y[b] * row;
      }
      sum += weights_[0][a][lane] * layer;
      by_x += slopes_x[a] * layer;
      by_y += weights_[0][a][lane] * slope;
    }
    const double by_z = (z - 0.5) * sum[0] - 2.0 * z * sum[1] + (z + 0.5) * sum[2];
    return {along_row(lane, sum), {along_row(lane, by_x), along_row(lane, by_y), by_z}};
  }

 private:
  /// Four numbers, added and multiplied element by element in every build.
  using Four [[gnu::vector_size(4 * sizeof(double))]] = double;

  double along_row(std::size_t lane, const Four& row) const {
    return weights_[2][0][lane] * row[0] + weights_[2][1][lane] * row[1] + weights_[2][2][lane] * row[2];
  }

  const double* values_;
  std::size_t row_, layer_;
  alignas(64) double weights_[3][3][simd::lanes];  ///< weights by axis, node and point; never negative
  alignas(64) double t_[3][simd::lanes];           ///< offset from the nearest node in [-1/2, 1/2], by axis and point
};

/// Number of iterations in which box_near() shrinks its box; further iterations hardly change it.
constexpr int kShrinkIterations = 3;

/// Returns the points that lie in the body, one bit for each of eight points.
std::uint8_t inside_bits(const SignedDistanceGrid& grid, const GridFrame& frame, const double* x, const double* y,
                         const double* z) {
  // Classify most points by their nearest node.
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
  // Evaluate the field for the remaining points.
  const GridSpline spline(grid, q, nearest);
  for (; mixed != 0; mixed &= mixed - 1) {
    const auto k = static_cast<std::size_t>(std::countr_zero(mixed));
    inside |= (spline.value(k, nearest[k]) <= 0.0 ? 1u : 0u) << k;
  }
  return static_cast<std::uint8_t>(inside);
}

Box intersection(const Box& a, const Box& b) {
  return {a.min.cwiseMax(b.min), a.max.cwiseMin(b.max)};
}

/// Returns the bounding box of a box that is rotated about the origin and then translated.
Box turned(const Box& box, const Mat3& rotation, const Vec3& position) {
  const Vec3 centre = rotation * (0.5 * (box.min + box.max)) + position;
  const Vec3 half = rotation.cwiseAbs() * (0.5 * (box.max - box.min));
  return {centre - half, centre + half};
}

/// Smallest valid length of the field's gradient with respect to node coordinates, in grid spacings. A shorter gradient
/// is only rounding: the closest points of the surface then surround the point, as at the centre of a ball.
constexpr double kUndefinedBelow = 1e-9;
/// Smallest step along a ray, in grid spacings.
constexpr double kMinStep = 0.125;
/// Maximum number of iterations of regula falsi. Ten iterations usually shrink a bracket of some spacings to rounding.
constexpr int kMaxIterations = 40;

/// The field phi_h at eight points anywhere, also outside of the grid; evaluated point by point.
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
  alignas(64) double out_[simd::lanes];  ///< distance from the grid [m]; 0 inside
  NearestNodes nearest_;
  GridSpline spline_;
};

/// Search for the point where a ray leaves the body. The caller evaluates the field: it reads next() and passes the
/// value to add_sample() until done().
class ExitSearch {
 public:
  ExitSearch() = default;
  explicit ExitSearch(const SignedDistanceGrid& grid)
      : min_step_(kMinStep * grid.spacing()), bound_(grid.error_bound()), max_distance_(2.0 * grid.reach()) {}

  bool done() const { return done_; }
  /// Returns the largest distance along the ray [m] known to be in the body.
  double exit() const { return inside_; }

  /// Distance along the ray at which to evaluate the field next.
  double next() const {
    if (bracketed_) return std::clamp(inside_ + (outside_ - inside_) * (below_ / (below_ - above_)), inside_, outside_);
    return inside_ + std::max({min_step_, -below_ / std::numbers::sqrt3, -below_ - 2.0 * bound_});
  }

  /// Adds the field's value at a distance along the ray. Continues the march until a point outside is found;
  /// afterwards shrinks the bracket.
  void add_sample(double distance, double value) {
    if (!bracketed_) return march(distance, value);
    // Illinois variant of regula falsi: if the same end of the bracket stays twice in succession, its value is halved.
    if (value <= 0.0) {
      inside_ = distance;
      below_ = value;
      if (last_ < 0) above_ *= 0.5;
      last_ = -1;
    } else {
      outside_ = distance;
      above_ = value;
      if (last_ > 0) below_ *= 0.5;
      last_ = 1;
    }
    done_ = value == 0.0 || ++iterations_ == kMaxIterations || outside_ - inside_ <= 1e-12 * min_step_;
  }

 private:
  void march(double distance, double value) {
    bracketed_ = value > 0.0;
    if (bracketed_) {
      outside_ = distance;
      above_ = value;
      done_ = below_ == 0.0;  // true if the start of the ray is on the surface
      return;
    }
    inside_ = distance;
    below_ = value;
    if (distance <= max_distance_) return;
    // The body is nowhere longer than max_distance_, so the direction of the ray is zero or not finite.
    inside_ = 0.0;
    done_ = true;
  }

  double min_step_ = 0.0, bound_ = 0.0, max_distance_ = 0.0;
  double inside_ = 0.0, below_ = 0.0, outside_ = 0.0, above_ = 0.0;
  int last_ = 0, iterations_ = 0;
  bool bracketed_ = false, done_ = false;
};

/// Returns the unit gradient in the world frame, or `otherwise` if the gradient is only rounding. `by_nodes`: gradient
/// with respect to the coordinates of the nodes [m].
Vec3 outwards(const GridFrame& frame, const Vec3& by_nodes, const Vec3& otherwise) {
  const double length = by_nodes.norm();
  if (!(length > kUndefinedBelow * frame.spacing)) return otherwise;
  return (frame.turn.transpose() * by_nodes).normalized();
}

}  // namespace

MeshTool::MeshTool(std::shared_ptr<const SignedDistanceGrid> grid)
    : ToolShape(grid->half_width(), grid->reach()), grid_(std::move(grid)) {}

void MeshTool::push_inside(const ToolPose& pose, const PointColumns& points, std::size_t packs,
                           ContactBuffer& contacts) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < packs * simd::lanes; i += simd::lanes) {
    const std::uint8_t hits = inside_bits(*grid_, frame, points.x + i, points.y + i, points.z + i);
    if (hits != 0) contacts.extend(simd::copy_selected(hits, points, i, contacts, contacts.size()));
  }
}

void MeshTool::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const GridFrame frame(*grid_, pose);
  const Pack slack(2.0 * grid_->error_bound()), margin2(margin * margin), spacing2(frame.spacing * frame.spacing);
  for (const PackRange range : ranges) {
    for (std::size_t pack = range.first; pack < range.last; ++pack) {
      const std::size_t i = pack * simd::lanes;
      GridPack q(frame, points.x + i, points.y + i, points.z + i);
      const Pack out2 = q.clamp(frame);
      const NearestNodes nearest(frame, q);
      alignas(64) double values[simd::lanes];
      for (std::size_t k = 0; k < simd::lanes; ++k) values[k] = grid_->values()[nearest[k]];
      // Lower bound of the distance from the closest point of the grid to the body.
      const Pack distance = simd::max(simd::load(values) - slack, Pack(0.0));
      *marks++ = range.own(simd::bits(out2 * spacing2 + distance * distance <= margin2), pack);
    }
  }
}

// Alternately shrinks `bounds` to its intersection with the tool's box, and the tool's box to its intersection with the
// shrunk bounds. The sides of the two boxes are not parallel, so each further iteration may shrink them.
Box MeshTool::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const Mat3 rotation = pose.rotation();
  const Mat3 back = rotation.transpose();
  const Box body{grid_->box().min - Vec3::Constant(margin), grid_->box().max + Vec3::Constant(margin)};
  // The slack [m] covers rounding in the rotations.
  const double slack = 1e-12 * (reach() + margin + pose.position.cwiseAbs().maxCoeff());
  Box part = body, near = turned(body, rotation, pose.position);
  for (int k = 0; k < kShrinkIterations; ++k) {
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
  // Grow the box so that it contains all points that mark_near() marks. Let e be the error bound, y the point of the
  // grid that is closest to a marked point, a the distance of the marked point from y, and b the lower bound that
  // mark_near() computes for the distance of y from the body. y is at most b + 3 e away from the mesh, and a^2 + b^2 <=
  // margin^2. So the marked point is at most a + b + 3 e <= sqrt(2) margin + 3 e away from the mesh. box() already is
  // the mesh's box grown by e.
  // Divide the grown box along its longest side into equal slices, with one ball around each slice.
  const Vec3 extent = grid_->box().size() + Vec3::Constant(3.0 * margin + 4.0 * grid_->error_bound());
  Eigen::Index longest = 0;
  const double length = extent.maxCoeff(&longest);
  const double across = math::hypot(extent[(longest + 1) % 3], extent[(longest + 2) % 3]);
  const double balls = std::ceil(length / across);
  return {static_cast<std::size_t>(balls), (1.0 + 1e-9) * 0.5 * math::hypot(across, length / balls)};
}

double MeshTool::displacement_bound(const ToolPose& from, const ToolPose& to) const noexcept {
  const double moved = (to.position - from.position).norm();
  // In most steps the tool does not rotate. All its points then move by the same displacement.
  if (to.axis == from.axis && to.roll == from.roll) return moved;
  return moved + (to.rotation() - from.rotation()).norm() / std::numbers::sqrt2 * reach();
}

std::vector<ProfilePoint> MeshTool::outline() const {
  const GridNodes& nodes = grid_->nodes();
  // Find the largest distance from the axis in each layer of nodes.
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
  // The rear end is the point of the body with the largest z in the tool frame. s = -z.
  std::vector<ProfilePoint> outline = {{-grid_->box().max.z(), 0.0}};
  for (std::size_t k = nodes.count[2]; k-- > 0;) {
    if (widest[k] >= 0.0) outline.push_back({-nodes.coordinate(2, k), widest[k]});
  }
  outline.push_back({-grid_->box().min.z(), 0.0});
  return outline;
}

ToolShape::Grown MeshTool::grown(double margin) const {
  // Compute a cylinder about the axis that contains the vertices, grown by the error bound and the margin.
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

// Marches along eight rays at once, which share the computation of the spline weights.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): the eight rays share the state of one loop.
void MeshTool::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  const GridFrame frame(*grid_, pose);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const std::size_t rays = std::min(contacts.size() - i, simd::lanes);
    std::array<ExitSearch, simd::lanes> searches;
    searches.fill(ExitSearch(*grid_));
    std::array<double, simd::lanes> distances{};
    // The first iteration evaluates the field at the contacts.
    for (bool first = true, busy = true; busy; first = false) {
      alignas(64) double x[simd::lanes] = {}, y[simd::lanes] = {}, z[simd::lanes] = {};
      busy = false;
      for (std::size_t k = 0; k < rays; ++k) {
        if (searches[k].done()) continue;
        busy = true;
        distances[k] = first ? 0.0 : searches[k].next();
        x[k] = contacts.x[i + k] + distances[k] * contacts.ux[i + k];
        y[k] = contacts.y[i + k] + distances[k] * contacts.uy[i + k];
        z[k] = contacts.z[i + k] + distances[k] * contacts.uz[i + k];
      }
      if (!busy) break;
      const FieldPack field(*grid_, frame, x, y, z);
      for (std::size_t k = 0; k < rays; ++k) {
        if (searches[k].done()) continue;
        // Contacts lie in the body up to rounding, so the first value counts as at most 0.
        const double value = field.value(k);
        searches[k].add_sample(distances[k], first && value > 0.0 ? 0.0 : value);
      }
    }
    for (std::size_t k = 0; k < rays; ++k) exits[i + k] = searches[k].exit();
  }
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the loop over the points keeps its state in registers.
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
      // Convex body: use the plane with this normal that touches the convex hull.
      if (grid_->convex()) {
        const Vec3 x = rotation.transpose() * (contacts.point(k) - pose.position);
        const Vec3 local = rotation.transpose() * m;
        contacts.depth[k] = grid_->hull().support(local) - local.dot(x);
        if (m.dot(wanted) > -contacts.depth[k]) {
          // If the displacement `wanted` violates the constraint, use the constraint of a flat face of the body
          // instead: the face that is most nearly parallel to the surface.
          const Vec3 back = rotation.transpose() * -normal;
          double largest = kFlush;
          for (const SignedDistanceGrid::Face& face : grid_->flat_faces()) {
            const double flush = face.normal.dot(back), depth = face.offset - face.normal.dot(x);
            if (flush <= largest || depth > slack) continue;
            largest = flush;
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

void MeshTool::support_points(const ToolPose& pose, const ContactBuffer& contacts,
                              const MutablePointArrays& surface_points) const noexcept {
  const Mat3 rotation = pose.rotation();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 point = rotation.transpose() * (contacts.point(i) - pose.position);
    const Vec3 support =
        pose.position + rotation * grid_->hull().foremost(rotation.transpose() * -contacts.normal(i), point);
    surface_points.x[i] = support.x();
    surface_points.y[i] = support.y();
    surface_points.z[i] = support.z();
  }
}

}  // namespace hapbench
