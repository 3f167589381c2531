#include "sim/tool/cylinder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/contact/push_hits.hpp"
#include "sim/tool/axial.hpp"

namespace hapbench {
namespace {

/// Writes the marks of the packs of all ranges, `test` being the mask of one. Pose and points are copied, because for
/// all the compiler knows a mark is a byte of whatever is referred to, and would have to be read again for the next
/// pack.
template <class Test>
void mark(const ToolPose pose, const PointArrays points, std::span<const PackRange> ranges, std::uint8_t* marks,
          const Test& test) {
  for (const PackRange range : ranges) {
    std::uint8_t* const first = marks;
    for (std::size_t i = range.first * simd::lanes; i < range.last * simd::lanes; i += simd::lanes) {
      *marks++ = simd::bits(test(AxialPack(pose, points.x + i, points.y + i, points.z + i)));
    }
    if (marks == first) continue;
    *first &= range.own_in_first;
    *(marks - 1) &= range.own_in_last;
  }
}

/// Appends the points of the ranges that pass the test. Copies for the same reason.
template <class Test>
void push(const ToolPose pose, const PointColumns points, std::span<const PackRange> ranges, ContactBuffer& contacts,
          const Test test) {
  for (const PackRange range : ranges) {
    for (std::size_t pack = range.first; pack < range.last; ++pack) {
      const std::size_t i = pack * simd::lanes;
      const std::uint8_t hits = simd::bits(test(AxialPack(pose, points.x + i, points.y + i, points.z + i)));
      if (hits == 0) continue;
      if (const std::uint8_t own = range.own(hits, pack); own != 0) push_hits(own, points, i, contacts);
    }
  }
}

/// The part of the axis with low <= s <= high, from the tip centre.
struct AxisPart {
  double low, high;
};

/// A point of the tool is no further than the radius from its projection on the axis, so the projections of points in
/// `bounds` lie in `bounds` grown by the radius. Comparisons with NaN leave the part as it is.
AxisPart part_near(AxisPart part, const ToolPose& pose, double radius, const Box& bounds) noexcept {
  for (int k = 0; k < 3; ++k) {
    const double a = pose.axis[k];
    const double from = bounds.min[k] - radius - pose.position[k], to = bounds.max[k] + radius - pose.position[k];
    if (a == 0.0) {
      if (from > 0.0 || to < 0.0) return {1.0, -1.0};
      continue;
    }
    part.low = std::max(part.low, (a > 0.0 ? from : to) / a);
    part.high = std::min(part.high, (a > 0.0 ? to : from) / a);
  }
  return part;
}

}  // namespace

double largest_square_within(double r) {
  constexpr double up = std::numeric_limits<double>::infinity();
  double square = r * r;
  while (std::sqrt(square) > r) square = std::nextafter(square, 0.0);
  while (std::sqrt(std::nextafter(square, up)) <= r) square = std::nextafter(square, up);
  return square;
}

Cylinder::Cylinder(double radius, double length, Tip tip)
    : ToolShape(radius, std::hypot(length, radius)),
      radius_(radius),
      length_(length),
      tip_(tip),
      radius2_(largest_square_within(radius)) {}

/// Calls `use` with the test of a pack of points for the body.
template <class Use>
void Cylinder::with_test(const Use& use) const {
  const simd::Pack bottom(-length_), radius2(radius2_), zero(0.0);
  const auto in_cylinder = [=](const AxialPack& q) { return q.s <= zero && q.s >= bottom && q.rho2 <= radius2; };
  if (tip_ == Tip::flat) return use(in_cylinder);
  use([=](const AxialPack& q) { return in_cylinder(q) || (q.s > zero && q.distance2() <= radius2); });
}

void Cylinder::mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                           std::uint8_t* marks) const noexcept {
  with_test([&](const auto& test) { mark(pose, points, ranges, marks, test); });
}

void Cylinder::push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                           ContactBuffer& contacts) const noexcept {
  with_test([&](const auto& test) { push(pose, points, ranges, contacts, test); });
}

void Cylinder::mark_near(const ToolPose& pose, double margin, const PointArrays& points,
                         std::span<const PackRange> ranges, std::uint8_t* marks) const noexcept {
  const double radius = radius_ + margin;
  const simd::Pack radius2(radius * radius), low(-length_ - margin), high(tip_ == Tip::round ? radius : margin);
  mark(pose, points, ranges, marks, [&](const AxialPack& q) { return q.s <= high && q.s >= low && q.rho2 <= radius2; });
}

Box Cylinder::box_near(const ToolPose& pose, double margin, const Box& bounds) const noexcept {
  const double radius = radius_ + margin;
  const AxisPart whole{-(length_ + margin), tip_ == Tip::round ? radius : margin};
  const AxisPart part = part_near(whole, pose, radius, bounds);
  if (part.low > part.high) return {Vec3::Ones(), -Vec3::Ones()};
  const Vec3 tip = pose.position + part.high * pose.axis;
  const Vec3 bottom = pose.position + part.low * pose.axis;
  // A disc with normal a has the half extent radius sqrt(1 - <a, e>^2) along e.
  const Vec3 disc = radius * (Vec3::Ones() - pose.axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return {tip.cwiseMin(bottom) - disc, tip.cwiseMax(bottom) + disc};
}

ToolShape::Cover Cylinder::cover(double margin) const {
  const double radius = radius_ + margin;
  const double length = length_ + margin + (tip_ == Tip::round ? radius : margin);
  const double balls = std::ceil(length / (2.0 * radius));
  // Each holds a slice of the cylinder.
  return {static_cast<std::size_t>(balls), (1.0 + 1e-9) * std::hypot(radius, length / balls / 2.0)};
}

/// The smallest rotation that takes one axis to the other moves a point of the tool by at most |a' - a| times its
/// distance from the tip centre; a turn about the axis moves no point of the body out of it.
double Cylinder::moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept {
  const double moved = (to.position - from.position).norm();
  // Adding a turn of zero changes no bit, and most steps of most scenes do not turn the tool.
  if (to.axis == from.axis) return moved;
  return moved + (to.axis - from.axis).norm() * reach();
}

ToolShape::Grown Cylinder::grown(double margin) const {
  const bool flat = tip_ == Tip::flat;  // a round tip grows with the radius
  const double ends = flat ? 2.0 * margin : margin;
  return {std::make_unique<Cylinder>(radius_ + margin, length_ + ends, tip_), flat ? margin : 0.0};
}

}  // namespace hapbench
