#pragma once

#include <algorithm>
#include <cmath>

#include "sim/contact/push_hits.hpp"
#include "sim/tool/axial.hpp"
#include "sim/tool/tool_shape.hpp"

/// What all solids of revolution answer a contact search alike. For source files only (see simd.hpp).
namespace hapbench {

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
  std::size_t size = contacts.size();
  for (const PackRange range : ranges) {
    for (std::size_t pack = range.first; pack < range.last; ++pack) {
      const std::size_t i = pack * simd::lanes;
      const std::uint8_t hits = simd::bits(test(AxialPack(pose, points.x + i, points.y + i, points.z + i)));
      if (hits == 0) continue;
      if (const std::uint8_t own = range.own(hits, pack); own != 0) size += copy_hits(own, points, i, contacts, size);
    }
  }
  contacts.extend(size - contacts.size());
}

/// The part of the axis with low <= s <= high, from the tip centre; none when low > high.
struct AxisPart {
  double low, high;
};

/// Of a body no further than `radius` from its axis the part that is near `bounds`: projections on the axis of points
/// in `bounds` lie in `bounds` grown by the radius. Comparisons with NaN leave the part as it is.
inline AxisPart part_near(AxisPart part, const ToolPose& pose, double radius, const Box& bounds) noexcept {
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

/// The box around a part of the axis with discs of this radius; an empty one around none.
inline Box box_around(const AxisPart& part, const ToolPose& pose, double radius) noexcept {
  if (part.low > part.high) return {Vec3::Ones(), -Vec3::Ones()};
  const Vec3 tip = pose.position + part.high * pose.axis;
  const Vec3 bottom = pose.position + part.low * pose.axis;
  // A disc with normal a has the half extent radius sqrt(1 - <a, e>^2) along e.
  const Vec3 disc = radius * (Vec3::Ones() - pose.axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return {tip.cwiseMin(bottom) - disc, tip.cwiseMax(bottom) + disc};
}

/// Balls in a row that hold a cylinder, as far apart as they are wide: each holds a slice.
inline ToolShape::Cover row_of_balls(double radius, double length) {
  const double balls = std::ceil(length / (2.0 * radius));
  return {static_cast<std::size_t>(balls), (1.0 + 1e-9) * std::hypot(radius, length / balls / 2.0)};
}

/// The smallest rotation that takes one axis to the other moves a point of the tool by at most |a' - a| times its
/// distance from the tip centre; a turn about the axis moves no point of the body out of it.
inline double axis_moved_at_most(const ToolPose& from, const ToolPose& to, double reach) noexcept {
  const double moved = (to.position - from.position).norm();
  // Adding a turn of zero changes no bit, and most steps of most scenes do not turn the tool.
  if (to.axis == from.axis) return moved;
  return moved + (to.axis - from.axis).norm() * reach;
}

}  // namespace hapbench
