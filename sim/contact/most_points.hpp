#pragma once

#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// An upper bound of how many points of the shell can lie in the balls at once, wherever they are: what buffers are
/// sized by. The points in the fullest cube that holds such a ball, grid cells rounded up, times the number of balls.
/// For the thesis's drill a sixth of the block's points. O(shell size).
std::size_t most_points_in(const PointShell& shell, const ToolShape::Cover& cover);

}  // namespace hapbench
