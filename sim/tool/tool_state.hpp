#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// Where the tool is, in the world frame: three numbers of position, two of axis, one of roll.
///
/// The axis is stored and not computed from an orientation, because it is what scripts give and what solids of
/// revolution read; the roll completes it to a rotation. The tool's own frame has its origin at the tip centre and its
/// axis along -z.
struct ToolPose {
  Vec3 position = Vec3::Zero();  ///< centre of the tip [m]
  Vec3 axis = {0.0, 0.0, -1.0};  ///< unit vector out of the tip
  double roll = 0.0;             ///< turn about the axis, right-handed [rad]; see rotation()

  /// From the tool's frame to the world's: the shortest turn of -z to the axis (half a turn about x when the axis is
  /// +z), and after that the turn by `roll` about the axis.
  Mat3 rotation() const noexcept;
};

/// The roll of a pose with this axis whose own x axis lies along `side`, in (-pi, pi]. Unit vectors, perpendicular.
double roll_towards(const Vec3& axis, const Vec3& side) noexcept;

/// Pose and velocity. The orientation is scripted, so the angular velocity is known and not integrated.
struct ToolState {
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();  ///< of the tip centre [m/s]
  /// Over the step before, perhaps low-passed [rad/s]; zero unless wanted. With the turn about the axis where the pose
  /// or the script (Motion::scripts_roll) has one.
  Vec3 angular_velocity = Vec3::Zero();
};

}  // namespace hapbench
