#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// The rotation vector that turns unit vector a to unit vector b the short way [rad]; zero for opposite ones.
inline Vec3 turn(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 cross = a.cross(b);
  const double sine = cross.norm();
  return sine > 0.0 ? Vec3(cross * (std::atan2(sine, a.dot(b)) / sine)) : Vec3::Zero();
}

/// The same of the whole pose, roll included.
Vec3 whole_turn(const ToolPose& from, const ToolPose& to) noexcept;

/// The rotation vector that turns one pose to the other [rad]. Where neither rolls, the axis turns the short way: a
/// solid of revolution, whose pose leaves its roll out, feels no other turn.
inline Vec3 turn(const ToolPose& from, const ToolPose& to) noexcept {
  if (from.roll == 0.0 && to.roll == 0.0) return turn(from.axis, to.axis);
  return whole_turn(from, to);
}

}  // namespace hapbench
