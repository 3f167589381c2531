#pragma once

#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "results/observe/metrics.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// What to know before the forces of a run are believed, a sentence each: it passed the limit of explicit friction
/// (results/observe/explicit_friction.hpp), or the reduction makes its force jump
/// (results/observe/reduction_jumps.hpp).
std::vector<std::string> force_warnings(const Metrics& metrics);

/// The same for what is known before the run: a proxy keeps points out of convex tools only.
std::vector<std::string> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool);

}  // namespace hapbench
