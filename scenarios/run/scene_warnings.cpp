#include "scenarios/run/scene_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/scene/named_files.hpp"
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
  // If the path is shorter than the intended length by at most the tool's width, the drag ends at an edge of the
  // surface, which is normal.
  if (to_cover <= path + 2.0 * tool.half_width()) return std::nullopt;
  const std::string ends = fmt::format(
      "the path of the drag ends after {}, but the hand would move {}: ", length_text(path), length_text(to_cover));
  return Warning{
      "short_path", "",
      ends + (fields.path ? "hand.path_m does not continue over the surface; choose its points on or near the surface"
                          : "there the surface ends, turns against hand.direction, or has no further point within "
                            "hand.smoothing_m; another initial.position_m, a larger hand.smoothing_m, a smaller point "
                            "spacing, or hand.path_m gives a longer path")};
}

std::string scale_question(const Scenario& scenario, const ToolShape& tool, const Box& environment) {
  // An environment is suspect if it is much smaller than the tool's thickness or much larger than the tool's length.
  // Millimetres taken for metres change either ratio by a factor of 1000.
  constexpr double kTooSmall = 0.1, kTooLarge = 100.0;
  const double size = diagonal(environment);
  if (size >= kTooSmall * 2.0 * tool.half_width() && size <= kTooLarge * tool.reach()) return "";
  if (std::holds_alternative<MeshToolFields>(scenario.tool)) return "are tool.scale and the environment's size right?";
  return size_question(scenario.environment);
}

std::string normals_question(const Environment& environment, const NamedFiles& files) {
  if (std::holds_alternative<PointShellEnvironment>(environment))
    return "are the normals in the file of the point shell reversed?";
  const bool is_open =
      std::holds_alternative<MeshEnvironment>(environment) && !files.at(kEnvironmentFile).mesh().knows_outside();
  return is_open ? "are the normals of an open scan inverted (environment.flip_normals)?" : "";
}

std::optional<Warning> trace_size_warning(const ContactTrace& trace, const ToolShape& tool) {
  if (trace.contacts.empty()) return std::nullopt;
  double deepest = 0.0;
  Box points = {trace.contacts.front().point, trace.contacts.front().point};
  for (const ContactTrace::Contact& contact : trace.contacts) {
    deepest = std::max(deepest, contact.depth);
    points.min = points.min.cwiseMin(contact.point);
    points.max = points.max.cwiseMax(contact.point);
  }
  const auto warning = [](std::string text) {
    return Warning{"trace_size", std::string(kContactFile),
                   text + ": are depth_m and the points of the trace in metres?"};
  };
  if (deepest > tool.reach())
    return warning(fmt::format("the deepest contact of the trace, {}, is deeper than the tool is long, {}",
                               length_text(deepest), length_text(tool.reach())));
  if (points.size().maxCoeff() > kLongestObject)
    return warning(fmt::format("the points of the trace span {}", size_text(points)));
  return std::nullopt;
}

std::string frame_problem(const Box& tool) {
  constexpr double kSuspectRatio = 2.0;  // if two lengths of the tool have a larger ratio, its frame is probably wrong
  const Vec3 size = tool.size();
  const double gap = distance_to(tool, Vec3::Zero());
  if (gap > 0.0) return fmt::format("is {} away from its tip centre", length_text(gap));
  const auto [short_side, long_side] = std::minmax(size.x(), size.y());
  if (long_side > kSuspectRatio * std::max(short_side, size.z())) return "is longer across its axis than along it";
  if (-tool.min.z() > kSuspectRatio * tool.max.z()) return "extends in front of its tip centre instead of behind it";
  return "";
}

std::vector<Warning> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool) {
  std::vector<Warning> warnings;
  if (rendering.algorithm == "proxy" && !tool.convex()) {
    warnings.push_back(
        {"not_convex", "",
         "the tool is not convex, so the proxy cannot guarantee that no point enters it: points may enter concave "
         "regions, such as the neck of a bur; use a convex tool or another algorithm"});
  }
  if (const auto* mesh = dynamic_cast<const MeshTool*>(&tool)) {
    const Box& box = mesh->grid().box();
    if (const std::string odd = frame_problem(box); !odd.empty()) {
      warnings.push_back(
          {"tool_frame", "",
           fmt::format(
               "the mesh of the tool {} (relative to the tip centre it spans {}): are tool.tip_m and tool.tip_axis "
               "right?",
               odd, bounds_text(box))});
    }
  }
  return warnings;
}

}  // namespace hapbench
