#include "sim/loop/stop_rules.hpp"

namespace hapbench {

StopRule when_tool_leaves_hole(const Vec3& up) {
  return {Outcome::leaves_hole, [up](const ToolState& tool) { return tool.pose.position.dot(up) > 0.0; }};
}

StopRule when_tool_is_horizontal(const Vec3& up) {
  return {Outcome::tool_horizontal, [up](const ToolState& tool) { return tool.pose.axis.dot(up) >= 0.0; }};
}

}  // namespace hapbench
