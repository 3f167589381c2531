#include "scenarios/run/scene_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "sim/tool/mesh_tool.hpp"

namespace hapbench {

const char* size_question(const Environment& environment) {
  if (std::holds_alternative<MeshEnvironment>(environment)) return "is environment.scale right?";
  if (std::holds_alternative<PointShellEnvironment>(environment))
    return "are the points of environment.file in metres?";
  return "are the sizes of environment in metres?";
}

std::optional<Warning> short_path_warning(const DragHandFields& fields, const DragHand& hand, double duration,
                                          const ToolShape& tool) {
  const double path = hand.path().length(), to_cover = intended_drag_length(fields, duration);
  // If the path is short by less than the tool's width, the drag ends at an edge of the surface, which is
  // normal.
  if (to_cover <= path + 2.0 * tool.half_width()) return std::nullopt;
  const std::string ends =
      fmt::format("the path of the drag ends after {} of {}: ", length_text(path), length_text(to_cover));
  return Warning{"short_path", "",
                 ends + (fields.path ? "hand.path_m leads no further over the surface; let its points lie on it"
                                     : "beyond, the surface ends or turns against hand.direction; another "
                                       "initial.position_m, a larger hand.smoothing_m or hand.path_m leads further")};
}

std::string scale_question(const Scenario& scenario, const ToolShape& tool, const Box& environment) {
  // Suspect: an environment much smaller than the tool's thickness or much larger than its length. Millimetres
  // taken for metres change either ratio by a factor of 1000.
  constexpr double kTooSmall = 0.1, kTooLarge = 100.0;
  const double size = diagonal(environment);
  if (size >= kTooSmall * 2.0 * tool.half_width() && size <= kTooLarge * tool.reach()) return "";
  if (std::holds_alternative<MeshToolFields>(scenario.tool)) return "are tool.scale and the environment's size right?";
  return size_question(scenario.environment);
}

std::string odd_frame(const Box& tool) {
  constexpr double kSuspectRatio = 2.0;  // ratio of lengths from which the frame is probably wrong
  const Vec3 size = tool.size();
  const double gap = distance_to(tool, Vec3::Zero());
  if (gap > 0.0) return fmt::format("lies {} away from its tip centre", length_text(gap));
  const auto [short_side, long_side] = std::minmax(size.x(), size.y());
  if (long_side > kSuspectRatio * std::max(short_side, size.z())) return "lies across its axis";
  if (-tool.min.z() > kSuspectRatio * tool.max.z()) return "lies before its tip centre, not behind";
  return "";
}

std::vector<Warning> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool) {
  std::vector<Warning> warnings;
  if (rendering.algorithm == "proxy" && !tool.convex()) {
    warnings.push_back(
        {"not_convex", "",
         "the tool is not convex: the proxy's guarantee that no point enters it is lost, points may enter "
         "where it is concave, as at the neck of a bur; a convex tool, or another algorithm, has no such "
         "gap"});
  }
  if (const auto* mesh = dynamic_cast<const MeshTool*>(&tool)) {
    const Box& box = mesh->grid().box();
    if (const std::string odd = odd_frame(box); !odd.empty()) {
      warnings.push_back(
          {"tool_frame", "",
           fmt::format("the tool {} (from there {}): are tool.tip_m and tool.tip_axis right?", odd, place_text(box))});
    }
  }
  return warnings;
}

}  // namespace hapbench
