#pragma once

#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "sim/core/types.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// How a tool within the box, in its own frame, lies otherwise than tools do, whose tip centre is the origin and whose
/// tip points along -z: the rest of a sentence about it, such as "lies across its axis"; empty when nothing is odd.
std::string odd_frame(const Box& tool);

/// What to know of a tool before its run is believed, a sentence each: a proxy keeps points out of convex tools only,
/// and a mesh may lie oddly in its frame.
std::vector<std::string> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool);

}  // namespace hapbench
