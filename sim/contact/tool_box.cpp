#include "sim/contact/tool_box.hpp"

namespace hapbench {

Box box_around(const Tool& tool, const ToolPose& pose, double margin) noexcept {
  const double radius = tool.radius + margin;
  const double beyond_tip = tool.tip == Tip::round ? radius : margin;
  const Vec3 tip = pose.position + beyond_tip * pose.axis;
  const Vec3 bottom = pose.position - (tool.length + margin) * pose.axis;
  // Of a disc with normal a, the half extent along e is radius sqrt(1 - <a, e>^2).
  const Vec3 disc = radius * (Vec3::Ones() - pose.axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return {tip.cwiseMin(bottom) - disc, tip.cwiseMax(bottom) + disc};
}

}  // namespace hapbench
