#include "sim/tool/mesh_tool.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/contact/push_hits.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/grid_spline.hpp"

namespace hapbench {
namespace {

using simd::Pack;

/// How often the box of the part near others is made smaller; it hardly shrinks any more.
constexpr int kShrinks = 3;

/// Calls `use` with the number of each bit that is set.
template <class Use>
void for_each_bit(std::uint8_t bits, const Use& use) {
  for (unsigned rest = bits; rest != 0; rest &= rest - 1) use(static_cast<std::size_t>(std::countr_zero(rest)));
}

/// Which of the eight points lie in the body.
std::uint8_t inside_bits(const SignedDistanceGrid& grid, const GridFrame& frame, const double* x, const double* y,
                         const double* z) {
  const GridPack q(frame, x, y, z);
  if (!simd::any(q.within)) return 0;
  const NearestNodes nearest(frame, q);
  unsigned inside = 0, mixed = 0;
  for (std::size_t k = 0; k < simd::lanes; ++k) {
    const unsigned kind = grid.kinds()[nearest[k]];  // the first node is outside
    inside |= (kind & 1u) << k;
    mixed |= (kind >> 1) << k;
  }
  if (mixed == 0) return static_cast<std::uint8_t>(inside);
  const GridSpline spline(grid, q, nearest);
  for_each_bit(static_cast<std::uint8_t>(mixed),
               [&](std::size_t k) { inside |= (spline.value(k, nearest[k]) <= 0.0 ? 1u : 0u) << k; });
  return static_cast<std::uint8_t>(inside);
}

/// Writes the marks of the packs of all ranges, `test` being that of the pack at a place.
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

/// The box around a box that is turned and then moved.
Box turned(const Box& box, const Mat3& rotation, const Vec3& position) {
  const Vec3 centre = rotation * (0.5 * (box.min + box.max)) + position;
  const Vec3 half = rotation.cwiseAbs() * (0.5 * (box.max - box.min));
  return {centre - half, centre + half};
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

/// What of the bounds is near the tool's box, and what of the tool's box is near that, in turns.
Box MeshTool::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const Mat3 rotation = pose.rotation();
  const Mat3 back = rotation.transpose();
  const Box body{grid_->low() - Vec3::Constant(margin), grid_->high() + Vec3::Constant(margin)};
  // Rounding of the turns, which `margin` does not know of.
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
  // Of a marked point, the nearest place in the grid is within b + 3 e of the mesh, and a + b <= sqrt(2) margin.
  const Vec3 extent = grid_->high() - grid_->low() + Vec3::Constant(3.0 * margin + 4.0 * grid_->error_bound());
  Eigen::Index longest = 0;
  const double length = extent.maxCoeff(&longest);
  const double across = std::hypot(extent[(longest + 1) % 3], extent[(longest + 2) % 3]);
  const double balls = std::ceil(length / across);
  return {static_cast<std::size_t>(balls), (1.0 + 1e-9) * 0.5 * std::hypot(across, length / balls)};
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
        widest[k] = std::max(widest[k], std::hypot(nodes.coordinate(0, i), nodes.coordinate(1, j)) + depth);
      }
    }
  }
  // From the far end, which is the body's highest place, to the tip.
  std::vector<ProfilePoint> outline = {{-grid_->high().z(), 0.0}};
  for (std::size_t k = nodes.count[2]; k-- > 0;) {
    if (widest[k] >= 0.0) outline.push_back({-nodes.coordinate(2, k), widest[k]});
  }
  outline.push_back({-grid_->low().z(), 0.0});
  return outline;
}

ToolShape::Grown MeshTool::grown(double margin) const {
  const double e = grid_->error_bound();
  double radius2 = 0.0;
  for (const Vec3& v : grid_->vertices()) radius2 = std::max(radius2, v.head<2>().squaredNorm());
  const double forward = -grid_->low().z() + margin;
  const double radius = std::max(std::sqrt(radius2) + e + margin, 1e-9 * reach());
  return {std::make_unique<Cylinder>(radius, grid_->high().z() - grid_->low().z() + 2.0 * margin, Tip::flat), forward};
}

}  // namespace hapbench
