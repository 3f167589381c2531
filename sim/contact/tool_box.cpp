#include "sim/contact/tool_box.hpp"

#include <algorithm>

namespace hapbench {
namespace {

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

Box box_around(const Tool& tool, const ToolPose& pose, double margin, const Box& bounds) noexcept {
  const double radius = tool.radius + margin;
  const AxisPart whole{-(tool.length + margin), tool.tip == Tip::round ? radius : margin};
  const AxisPart part = part_near(whole, pose, radius, bounds);
  if (part.low > part.high) return {Vec3::Ones(), -Vec3::Ones()};
  const Vec3 tip = pose.position + part.high * pose.axis;
  const Vec3 bottom = pose.position + part.low * pose.axis;
  // Of a disc with normal a, the half extent along e is radius sqrt(1 - <a, e>^2).
  const Vec3 disc = radius * (Vec3::Ones() - pose.axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return {tip.cwiseMin(bottom) - disc, tip.cwiseMax(bottom) + disc};
}

}  // namespace hapbench
