#include "scenarios/run/scene_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "results/observe/inside_observer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/recordings.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {
namespace {

/// Returns the pose of the tool at the start.
ToolPose first_pose(const Scenario& scenario, const SimulationParts& parts) {
  parts.hand->reset();  // needed because the hand may control the orientation
  const bool is_free = parts.motion->position_is_free();
  return {is_free ? scenario.initial.position : parts.motion->position_at(0.0), parts.motion->axis_at(0.0),
          parts.motion->roll_at(0.0)};
}

constexpr double kTypicalStep = 0.001;  ///< typical time step of haptic loops [s]
/// If the ratio of two lengths or times is at least this, their units are probably different: the factor is 1000 for
/// mm instead of m, and 100 for cm instead of m.
constexpr double kUnitFactor = 100.0;

/// Returns a warning if the environment is much smaller or larger than objects that a hand works on.
std::optional<Warning> size_warning(const Environment& environment, const Box& box) {
  const double longest = box.size().maxCoeff();
  const bool may_be_a_patch = std::holds_alternative<PointShellEnvironment>(environment);
  if (longest <= kLongestObject && (longest >= kShortestObject || may_be_a_patch)) return std::nullopt;
  return Warning{"size", "",
                 fmt::format("the environment is {} in size; usual environments are {} ... {} long: {}", size_text(box),
                             length_text(kShortestObject), length_text(kLongestObject), size_question(environment))};
}

/// Returns a warning if the points of a mesh are so far apart that the tool feels each point. Does not check
/// other environments: if a formula defines the surface, the scenario states the spacing.
std::optional<Warning> spacing_warning(const LoadedScenario& loaded, const ToolShape& tool) {
  // Point spacings as fractions of the tool's width: spacings up to kRoughSpacing cause no warning; "hapbench new"
  // chooses kSmoothSpacing.
  constexpr double kSmoothSpacing = 0.1, kRoughSpacing = 1.0 / 6.0;
  if (!std::holds_alternative<MeshEnvironment>(loaded.scenario.environment)) return std::nullopt;
  const PointDistance distance = *point_distance(loaded);
  const double width = 2.0 * tool.half_width();
  if (distance.metres <= kRoughSpacing * width) return std::nullopt;
  return Warning{"spacing", distance.is_given ? "/environment/spacing_m" : "/environment",
                 fmt::format("{} are {} apart, which a tool {} wide feels as a rough surface; try --set {}={:.1g}",
                             distance.is_given ? "the points" : "the mesh's vertices", length_text(distance.metres),
                             length_text(width), distance.path, kSmoothSpacing * width)};
}

/// Returns a warning if the tool starts at a distance from the environment that is more than kUnitFactor times the size
/// of the tool or of the environment, whichever is smaller.
std::optional<Warning> start_warning(const ToolShape& tool, const SceneFacts::Surface& surface) {
  const double smaller = std::min(diagonal(surface.box), tool.reach());
  const double gap = surface.start.distance;
  if (!(gap > kUnitFactor * smaller)) return std::nullopt;
  return Warning{
      "start", "",
      fmt::format("the tool starts {}{} from the environment, {:.0f} times the size of {}: is its position in metres?",
                  surface.start.is_estimate ? "about " : "", length_text(gap), gap / smaller,
                  smaller == tool.reach() ? "the tool" : "the environment")};
}

/// Returns warnings about lengths of a stroke that probably have wrong units. stroke_clock_warning() checks the times.
std::vector<Warning> stroke_warnings(const Stroke& stroke, const ToolShape& tool, const Box& environment) {
  // Compare the extent of the stroke with the environment and the tool.
  const auto samples = stroke.motion.samples();
  Box box = Box::nothing();
  for (const RecordedMotion::Sample& sample : samples) box.add(sample.position);
  const double size = diagonal(environment), extent = diagonal(box);
  const std::string of = fmt::format("the positions of the stroke span {}", size_text(box));
  std::vector<Warning> warnings;
  const auto warn = [&warnings](std::string text) {
    warnings.push_back({"stroke", std::string(kMotionFile), std::move(text)});
  };
  if (extent > kUnitFactor * size) {
    warn(fmt::format("{}, {:.0f} times the environment's size: are they in metres?", of, extent / size));
  } else if (extent > 0.0 && kUnitFactor * extent < tool.half_width()) {
    warn(fmt::format("{}, a hundredth of the tool's half width, {}: are they in metres?", of,
                     length_text(tool.half_width())));
  }
  return warnings;
}

/// Returns a warning if the tool starts behind the surface. Tests the point `core` on the tool's axis, core_offset()
/// behind the tip centre: whether `core` lies on the side of its nearest surface point that is opposite to the normal
/// of this surface point. `normals`: normals_question() of the environment.
std::optional<Warning> wrong_side_warning(const PointShell& shell, const ToolShape& tool, const ToolPose& pose,
                                          const std::string& normals) {
  const Vec3 core = pose.position - core_offset(tool) * pose.axis;
  // Find the nearest point of the surface.
  std::size_t nearest = 0;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const double to_point = (shell.point(i).position - core).norm();
    if (to_point >= distance) continue;
    nearest = i;
    distance = to_point;
  }
  // Cosine of about 45 degrees. If the angle between the direction from the surface point to the core and the reversed
  // normal is below 45 degrees, the core lies behind the point and not beside an edge of the surface.
  constexpr double kBehind = 0.7;
  const SurfacePoint point = shell.point(nearest);
  const double behind = point.normal.dot(point.position - core);
  if (behind <= 0.0 || behind < kBehind * distance) return std::nullopt;
  return Warning{
      "wrong_side", "",
      fmt::format("the tool starts {} behind the surface, on the side opposite to its normals: does the tool start "
                  "inside{}",
                  length_text(behind), normals.empty() ? "?" : ", or " + normals)};
}

/// Returns a warning if the sizes of tool and environment are out of proportion.
std::optional<Warning> scale_warning(const Scenario& scenario, const ToolShape& tool, const Box& environment) {
  const std::string question = scale_question(scenario, tool, environment);
  if (question.empty()) return std::nullopt;
  const bool is_mesh = std::holds_alternative<MeshToolFields>(scenario.tool);
  return Warning{
      "scale", "",
      fmt::format("the tool is {} wide and reaches {} from its tip centre, and the environment is {} in size: {}{}",
                  length_text(2.0 * tool.half_width()), length_text(tool.reach()), size_text(environment),
                  is_mesh ? "" : "are the tool's lengths in metres, or ", question)};
}

/// Returns a warning if the time step probably has a wrong unit.
std::optional<Warning> step_warning(double step) {
  if (step <= kUnitFactor * kTypicalStep && kUnitFactor * step >= kTypicalStep) return std::nullopt;
  return Warning{
      "step", "/time/step_s",
      fmt::format("{:.3g} s per step, while haptic loops usually have 1 ms: is the value in seconds?", step)};
}

/// Collects the warnings of a scene. Each check may return nothing.
class WarningList {
 public:
  void add(std::optional<Warning> warning) {
    if (warning) warnings_.push_back(std::move(*warning));
  }
  void add(std::vector<Warning> warnings) {
    for (Warning& warning : warnings) warnings_.push_back(std::move(warning));
  }
  std::vector<Warning> take() { return std::move(warnings_); }

 private:
  std::vector<Warning> warnings_;
};

/// Adds warnings about sizes. Precondition: the environment's points do not all have the same position.
void add_size_warnings(WarningList& warnings, const LoadedScenario& loaded, const ToolShape& tool,
                       const SceneFacts::Surface& surface) {
  const Scenario& scenario = loaded.scenario;
  if (auto scale = scale_warning(scenario, tool, surface.box)) {
    warnings.add(std::move(scale));
  } else {
    warnings.add(size_warning(scenario.environment, surface.box));
    warnings.add(spacing_warning(loaded, tool));
  }
  warnings.add(start_warning(tool, surface));
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position))
    warnings.add(stroke_warnings(*loaded.files.at(kMotionFile).stroke(), tool, surface.box));
}

}  // namespace

SceneFacts scene_facts(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  const double step = scenario.time.step;
  SceneFacts facts;
  WarningList warnings;

  // Check the time step and the tool.
  warnings.add(step_warning(step));
  facts.tool = make_tool(scenario, loaded.files);
  const ToolShape& tool = *facts.tool;
  warnings.add(tool_warnings(scenario.rendering, tool));

  // Build the environment's point shell. Without points, the remaining checks do not apply.
  const auto shell = make_shell(scenario, loaded.files);
  throw_if_stopped();  // building the shell may have taken seconds
  if (!shell || shell->size() == 0) {
    facts.warnings = warnings.take();
    return facts;
  }
  if (std::holds_alternative<MeshEnvironment>(scenario.environment))
    facts.is_closed = loaded.files.at(kEnvironmentFile).mesh().knows_outside();

  // Check the path of a drag.
  Scenario assembled = scenario;
  if (scenario.rendering.contact_source == kContactPlugin)
    assembled.rendering.contact_source = kComputedContacts;  // loads no library; the contacts do not matter here
  const SimulationParts parts = assemble(assembled, loaded.files, shell, {});
  if (const auto* hand = dynamic_cast<const DragHand*>(parts.hand.get())) {
    const double duration = step * static_cast<double>(scenario.time.steps - 1);  // time of the last step
    warnings.add(short_path_warning(std::get<DragHandFields>(scenario.hand), *hand, duration, tool));
  }

  // Check the sizes and the initial position of the tool.
  const ToolPose pose = first_pose(scenario, parts);
  facts.surface = SceneFacts::Surface{shell->bounds(), shell->size(), gap_between(tool, pose, *shell)};
  const bool has_size = facts.surface->box.min != facts.surface->box.max;  // false for a shell with a single point
  if (has_size) add_size_warnings(warnings, loaded, tool, *facts.surface);
  warnings.add(wrong_side_warning(*shell, tool, pose, normals_question(scenario.environment, loaded.files)));
  facts.warnings = warnings.take();
  return facts;
}

}  // namespace hapbench
