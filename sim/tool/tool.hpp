#pragma once

#include "sim/core/types.hpp"

namespace hapbench {

/// The tool (end-effector), a drill's stylus: a cylinder with a flat or a round tip.
///
///      <----------- length L ----------->
///     +----------------------------------+           s = <x - position, axis> along the axis:
///     |  bottom, s = -L                  p --> axis  the body has -L <= s <= 0 and radial distance <= radius
///     +----------------------------------+
///
/// The tool's position p is the centre of the tip, its axis the unit vector pointing out of the tip. A round tip adds
/// the half ball of the same radius about p beyond the tip plane (thesis A.1.1, B.1).
enum class Tip { flat, round };

struct Tool {
  double radius = 0.0005;  ///< [m]
  double length = 0.01;    ///< [m], from the tip plane to the bottom
  Tip tip = Tip::flat;
};

/// Where the tool is, in the world frame.
struct ToolPose {
  Vec3 position = Vec3::Zero();  ///< centre of the tip [m]
  Vec3 axis = {0.0, 0.0, -1.0};  ///< unit vector out of the tip
};

/// Pose and velocity. The orientation is scripted, so the angular velocity is known and not integrated; it lacks the
/// turn about the tool's own axis, which changes nothing in a solid of revolution.
struct ToolState {
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();          ///< of the tip centre [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< over the step before, perhaps low-passed [rad/s]; zero unless wanted
};

}  // namespace hapbench
