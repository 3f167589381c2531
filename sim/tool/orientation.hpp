#pragma once

#include <Eigen/Geometry>

#include "sim/core/types.hpp"

namespace hapbench {

/// Returns the axis of a tool whose rotation from the tool frame to the world frame is this unit quaternion.
Vec3 axis_of(const Eigen::Quaterniond& orientation) noexcept;
/// Returns ToolPose::roll of a tool with this rotation, in (-pi, pi] [rad].
double roll_of(const Eigen::Quaterniond& orientation) noexcept;

}  // namespace hapbench
