#pragma once

#include <memory>

#include "sim/contact/contact_query.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Returns the contact search with neighbour lists, which tests only points near the tool. Its contacts are
/// bitwise identical to brute force (make_contact_query). Shell and tool must outlive the search. Builds a grid
/// of the points: O(shell size).
std::unique_ptr<ContactQuery> make_neighbour_list_query(const PointShell& shell, const ToolShape& tool);

}  // namespace hapbench
