#pragma once

#include <memory>

#include "sim/contact/contact_query.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The search by neighbour lists, whose answers are those of brute force bit by bit (make_contact_query). It tests the
/// points near the tool only. Shell and tool must outlive it. Builds a grid of the points: O(shell size).
std::unique_ptr<ContactQuery> make_neighbour_list_query(const PointShell& shell, const ToolShape& tool);

}  // namespace hapbench
