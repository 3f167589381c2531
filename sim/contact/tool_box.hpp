#pragma once

#include "sim/core/types.hpp"
#include "sim/tool/tool.hpp"

namespace hapbench {

/// An axis-aligned box in the world frame [m].
struct Box {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

/// A box that holds every point of `bounds` that lies in the tool grown by `margin` [m] on all sides: the box around
/// the part of the tool near `bounds`, since most of a tilted tool sticks out of what it works on. Empty, with min >
/// max, when no part is near.
Box box_around(const Tool& tool, const ToolPose& pose, double margin, const Box& bounds) noexcept;

}  // namespace hapbench
