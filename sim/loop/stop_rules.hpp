#pragma once

#include "sim/loop/simulation.hpp"

/// What ends the thesis's peg-in-hole runs (A.1.2). `up` is the unit vector against gravity.
namespace hapbench {

/// The tip centre has risen above height 0, where the hole's mouth is.
StopRule when_tool_leaves_hole(const Vec3& up);

/// The tool's axis, which points down at first, has reached the plane perpendicular to `up`.
StopRule when_tool_is_horizontal(const Vec3& up);

}  // namespace hapbench
