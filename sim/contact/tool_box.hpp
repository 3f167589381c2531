#pragma once

#include "sim/core/types.hpp"
#include "sim/tool/tool.hpp"

namespace hapbench {

/// An axis-aligned box in the world frame [m].
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

/// The box around the tool grown by `margin` [m] on all sides.
Box box_around(const Tool& tool, const ToolPose& pose, double margin) noexcept;

}  // namespace hapbench
