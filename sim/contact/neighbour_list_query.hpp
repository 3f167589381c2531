#pragma once

#include <memory>

#include "sim/contact/contact_query.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Returns the contact search with neighbour lists, which tests only points near the tool. Its contacts are
/// bitwise identical to brute force (make_contact_query). Shell and tool must outlive the search. The first search in a
/// shell builds the grid of its points, O(shell size); later searches in the shell use the same grid.
std::unique_ptr<ContactQuery> make_neighbour_list_query(const PointShell& shell, const ToolShape& tool);

/// Returns an upper bound of the number of shell points that can lie in the balls of `cover` at once, wherever the
/// balls are. Used as the capacity of buffers. The bound is the number of balls times the largest number of points in a
/// cube of grid cells that is large enough for one ball (PointShell::max_points_in_ball). For the drill and the block
/// of the thesis, the bound is a sixth of the block's points.
std::size_t max_points_in(const PointShell& shell, const ToolShape::Cover& cover);

}  // namespace hapbench
