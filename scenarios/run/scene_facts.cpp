#include "scenarios/run/scene_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/description/descriptions.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/tool/mesh_tool.hpp"

namespace hapbench {
namespace {

/// The tool's pose in the first row.
ToolPose first_pose(const Scenario& scenario, const SimulationParts& parts) {
  parts.hand->reset();  // it may steer the orientation
  const bool is_free = parts.motion->position_is_free();
  return {is_free ? scenario.initial.position : parts.motion->position_at(0.0), parts.motion->axis_at(0.0),
          parts.motion->roll_at(0.0)};
}

void place_tool(const ToolShape& tool, const ToolPose& pose, const PointShell& shell, SceneFacts::Surface& surface) {
  constexpr std::size_t kAtOnce = 4096;  // keeps the buffer small, however large the shell
  ContactBuffer points(std::min(kAtOnce, shell.size()));
  surface.gap = std::numeric_limits<double>::infinity();
  for (std::size_t first = 0; first < shell.size(); first += kAtOnce) {
    points.clear();
    for (std::size_t i = first; i < std::min(first + kAtOnce, shell.size()); ++i) {
      const SurfacePoint point = shell.point(i);
      points.push(static_cast<std::uint32_t>(i), point.position, point.normal);
    }
    tool.surface_constraints(pose, Vec3::Zero(), 0.0, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      surface.gap = std::min(surface.gap, -points.depth[i]);
      if (points.depth[i] >= 0.0) ++surface.touching;
    }
  }
}

ToolFacts tool_facts(const Scenario& scenario, const NamedFiles& files, const ToolShape& tool) {
  ToolFacts facts{tool_names()[scenario.tool.index()], tool.half_width(), tool.reach(), tool.convex(), {}};
  const auto* mesh = dynamic_cast<const MeshTool*>(&tool);
  if (mesh == nullptr) return facts;
  const SignedDistanceGrid& grid = mesh->grid();
  facts.mesh = {files.at(kToolFile).mesh().triangles().triangles.size(),
                {grid.low(), grid.high()},
                grid.nodes().spacing,
                grid.error_bound()};
  return facts;
}

}  // namespace

SceneFacts scene_facts(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  SceneFacts facts;
  if (const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand))
    facts.trials = hand->subjects.size() * static_cast<std::size_t>(hand->trials);
  const auto tool = make_tool(scenario, loaded.files);
  facts.tool = tool_facts(scenario, loaded.files, *tool);
  facts.warnings = tool_warnings(scenario.rendering, *tool);
  facts.memory = expected_memory(scenario, loaded.files);
  const auto shell = make_shell(scenario, loaded.files);
  throw_if_stopped();  // that may have taken seconds
  if (!shell || shell->size() == 0) return facts;
  if (std::holds_alternative<MeshEnvironment>(scenario.environment))
    facts.is_closed = loaded.files.at(kEnvironmentFile).mesh().open_edges().empty();
  const SimulationParts parts = assemble(scenario, loaded.files, shell, {});
  SceneFacts::Surface& surface = facts.surface.emplace(SceneFacts::Surface{});
  surface.box = shell->bounds();
  surface.points = shell->size();
  if (auto warning = scale_warning(scenario, *tool, surface.box)) facts.warnings.push_back(*warning);
  if (const auto* hand = dynamic_cast<const DragHand*>(parts.hand.get())) {
    const auto& fields = std::get<DragHandFields>(scenario.hand);
    const double way = way_to_cover(fields, scenario.time.step * static_cast<double>(scenario.time.steps));
    if (auto warning = short_path_warning(fields, hand->path().length(), way, 2.0 * tool->half_width()))
      facts.warnings.push_back(*warning);
  }
  place_tool(*tool, first_pose(scenario, parts), *shell, surface);
  return facts;
}

namespace {

struct Unit {
  double per_metre;
  const char* name;
};

Unit unit_for(double metres) {
  const double size = std::abs(metres);
  if (size >= 1.0 || size == 0.0) return {1.0, "m"};
  return size >= 1e-4 ? Unit{1e3, "mm"} : Unit{1e6, "um"};
}

}  // namespace

std::string length_text(double metres) {
  const Unit unit = unit_for(metres);
  return fmt::format("{:.3g} {}", metres * unit.per_metre, unit.name);
}

std::string size_text(const Box& box) {
  const Vec3 size = box.max - box.min;
  const Unit unit = unit_for(size.maxCoeff());
  const Vec3 n = size * unit.per_metre;
  return fmt::format("{:.3g} x {:.3g} x {:.3g} {}", n.x(), n.y(), n.z(), unit.name);
}

std::string place_text(const Box& box) {
  const Unit unit = unit_for(std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff()));
  const Vec3 a = box.min * unit.per_metre, b = box.max * unit.per_metre;
  return fmt::format("x {:.3g} ... {:.3g}, y {:.3g} ... {:.3g}, z {:.3g} ... {:.3g} {}", a.x(), b.x(), a.y(), b.y(),
                     a.z(), b.z(), unit.name);
}

}  // namespace hapbench
