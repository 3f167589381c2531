#include "scenarios/run/tool_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/run/quantity_text.hpp"
#include "sim/tool/mesh_tool.hpp"

namespace hapbench {

std::string odd_frame(const Box& tool) {
  constexpr double kOdd = 2.0;  // as far this way as the other, or further, is no accident
  const Vec3 size = tool.max - tool.min;
  const double gap = distance_to(tool, Vec3::Zero());
  if (gap > 0.0) return fmt::format("lies {} away from its tip centre", length_text(gap));
  const auto [short_side, long_side] = std::minmax(size.x(), size.y());
  if (long_side > kOdd * std::max(short_side, size.z())) return "lies across its axis";
  if (-tool.min.z() > kOdd * tool.max.z()) return "lies before its tip centre, not behind";
  return "";
}

std::vector<std::string> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool) {
  std::vector<std::string> warnings;
  if (rendering.algorithm == "proxy" && !tool.convex()) {
    warnings.push_back(
        "the tool is not convex: the proxy's guarantee that no point enters it is lost, points may enter where it is concave, "
        "as at the neck of a bur; a convex tool, or another algorithm, has no such gap");
  }
  if (const auto* mesh = dynamic_cast<const MeshTool*>(&tool)) {
    const Box box{mesh->grid().low(), mesh->grid().high()};
    if (const std::string odd = odd_frame(box); !odd.empty()) {
      warnings.push_back(fmt::format(
          "the tool {} (from there {}): are tool.tip_m and tool.tip_axis right? \"hapbench new tool\" guesses them",
          odd, place_text(box)));
    }
  }
  return warnings;
}

}  // namespace hapbench
