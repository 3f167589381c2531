#include "scenarios/run/scene_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "results/observe/inside_observer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/recordings.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/tool/mesh_tool.hpp"

namespace hapbench {
namespace {

ToolPose first_pose(const Scenario& scenario, const SimulationParts& parts) {
  parts.hand->reset();  // it may steer the orientation
  const bool is_free = parts.motion->position_is_free();
  return {is_free ? scenario.initial.position : parts.motion->position_at(0.0), parts.motion->axis_at(0.0),
          parts.motion->roll_at(0.0)};
}

constexpr double kUsualStep = 0.001;  ///< of haptic loops [s]
/// Lengths and times this far apart are of different units: mm for m is a factor of 1000, cm for m one of 100.
constexpr double kUnitsApart = 100.0;

/// The question about the field that makes an environment as large as it is.
const char* size_question(const Environment& environment) {
  if (std::holds_alternative<MeshEnvironment>(environment)) return "is environment.scale right?";
  if (std::holds_alternative<PointShellEnvironment>(environment))
    return "are the points of environment.file in metres?";
  return "are the sizes of environment in metres?";
}

/// An environment that no hand works on, whatever the size of the tool.
std::optional<Warning> size_warning(const Environment& environment, const Box& box) {
  const double longest = box.size().maxCoeff();
  const bool may_be_a_patch = std::holds_alternative<PointShellEnvironment>(environment);
  if (longest <= kLongestObject && (longest >= kShortestObject || may_be_a_patch)) return std::nullopt;
  return Warning{"size", "",
                 fmt::format("the environment is {}; a hand works on what is {} ... {} long: {}", size_text(box),
                             length_text(kShortestObject), length_text(kLongestObject), size_question(environment))};
}

/// Points of a mesh so far apart that the tool feels each. Surfaces of formulas have the spacing they were given.
std::optional<Warning> spacing_warning(const LoadedScenario& loaded, const ToolShape& tool) {
  constexpr double kSmooth = 0.1, kRough = 1.0 / 6.0;  // of the tool's width; "hapbench new" takes the former
  if (!std::holds_alternative<MeshEnvironment>(loaded.scenario.environment)) return std::nullopt;
  const PointDistance distance = *point_distance(loaded);
  const double width = 2.0 * tool.half_width();
  if (distance.metres <= kRough * width) return std::nullopt;
  return Warning{"spacing", distance.is_given ? "/environment/spacing_m" : "/environment",
                 fmt::format("{} are {} apart; a tool of {} feels them as a rough surface; --set {}={:.1g}",
                             distance.is_given ? "the points" : "the mesh's vertices", length_text(distance.metres),
                             length_text(width), distance.path, kSmooth * width)};
}

std::optional<Warning> start_warning(const ToolShape& tool, const SceneFacts::Surface& surface) {
  const double least = std::min(diagonal(surface.box), tool.reach());
  const double gap = surface.start.distance;
  if (!(gap > kUnitsApart * least)) return std::nullopt;
  return Warning{
      "start", "",
      fmt::format("the tool starts {} from the environment, {:.0f} times the size of {}: is its place in metres?",
                  length_text(gap), gap / least, least == tool.reach() ? "the tool" : "the environment")};
}

std::vector<Warning> stroke_warnings(const Stroke& stroke, const TimeFields& time, const ToolShape& tool,
                                     const Box& environment) {
  const auto samples = stroke.motion.samples();
  Box box = Box::nothing();
  for (const RecordedMotion::Sample& sample : samples) box.add(sample.position);
  const double size = diagonal(environment), way = diagonal(box);
  const std::string of = fmt::format("the stroke's places are within {}", size_text(box));
  std::vector<Warning> warnings;
  const auto warn = [&warnings](std::string text) {
    warnings.push_back({"stroke", std::string(kMotionFile), std::move(text)});
  };
  if (way > kUnitsApart * size) {
    warn(fmt::format("{}, {:.0f} times the environment's size: are they in metres?", of, way / size));
  } else if (way > 0.0 && kUnitsApart * way < tool.half_width()) {
    warn(fmt::format("{}, a hundredth of the tool's half width, {}: are they in metres?", of,
                     length_text(tool.half_width())));
  }
  if (samples.size() < 2) return warnings;
  const double interval = (samples.back().time - samples.front().time) / static_cast<double>(samples.size() - 1);
  if (interval > kUnitsApart * time.step || interval * kUnitsApart < time.step) {
    warn(fmt::format(
        "the stroke has a sample each {:.3g} ms, the run a step each {:.3g} ms: are times in seconds, and is "
        "time.step_s right?",
        1e3 * interval, 1e3 * time.step));
  }
  return warnings;
}

/// Says that the foremost place of the tool's core is behind a surface, on the side away from its normals.
std::optional<Warning> wrong_side_warning(const PointShell& shell, const ToolShape& tool, const ToolPose& pose) {
  const Vec3 core = pose.position - way_to_core(tool) * pose.axis;
  std::size_t nearest = 0;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const double d = (shell.point(i).position - core).norm();
    if (d < distance) nearest = i, distance = d;
  }
  constexpr double kBehind = 0.7;  // cosine of 45 degrees: not beside an edge
  const SurfacePoint point = shell.point(nearest);
  const double behind = point.normal.dot(point.position - core);
  if (behind <= 0.0 || behind < kBehind * distance) return std::nullopt;
  return Warning{
      "wrong_side", "",
      fmt::format("the tool starts {} behind the surface, on the side its normals point away from: does it start "
                  "inside, or are the normals of an open scan inverted (environment.flip_normals)?",
                  length_text(behind))};
}

constexpr double kAlways = std::numeric_limits<double>::infinity();

/// The time until which a script moves [s]: 0 if it never does.
double moves_until(const Profile& profile) {
  if (profile.is_constant()) return 0.0;
  const auto* way = std::get_if<Profile::Waypoints>(&profile.shape());
  return way != nullptr ? way->points.back().first : kAlways;
}

double period_of(const Profile& profile) {
  const auto* sine = std::get_if<Profile::Sine>(&profile.shape());
  return sine != nullptr && !profile.is_constant() ? sine->period_s : 0.0;
}

/// The scripts of the hand; none of one that is moved otherwise, and of none.
std::span<const Profile> scripts_of(const HandFields& hand) {
  if (const auto* force = std::get_if<ForceHandFields>(&hand)) return force->force;
  if (const auto* push = std::get_if<PushHandFields>(&hand)) return {&push->force, 1};
  if (const ImpedanceHandFields* spring = spring_of(hand)) return spring->target;
  return {};
}

double largest(const Scenario& scenario, double (*of)(const Profile&)) {
  double most = 0.0;
  for (const Profile& script : scripts_of(scenario.hand)) most = std::max(most, of(script));
  const auto& orientation = scenario.motion.orientation;
  return orientation ? std::max({most, of(orientation->tilt), of(orientation->azimuth)}) : most;
}

/// The mean distance of a mesh's vertices [m].
double vertex_distance(const TriangleSoup& soup) {
  double area = 0.0;
  for (const auto& [a, b, c] : soup.triangles) {
    const Vec3& corner = soup.vertices[a];
    area += 0.5 * (soup.vertices[b] - corner).cross(soup.vertices[c] - corner).norm();
  }
  return std::sqrt(area / static_cast<double>(soup.vertices.size()));
}

struct Unit {
  double per_metre;
  const char* name;
};

Unit unit_for(double metres) {
  const double size = std::abs(metres);
  if (size >= 1.0 || size == 0.0) return {1.0, "m"};
  return size >= 1e-4 ? Unit{1e3, "mm"} : Unit{1e6, "um"};
}

std::optional<Warning> scale_warning(const Scenario& scenario, const ToolShape& tool, const Box& environment) {
  const std::string question = scale_question(scenario, tool, environment);
  if (question.empty()) return std::nullopt;
  const bool is_mesh = std::holds_alternative<MeshToolFields>(scenario.tool);
  return Warning{"scale", "",
                 fmt::format("the tool is {} thick and reaches {}, the environment is {}: {}{}",
                             length_text(2.0 * tool.half_width()), length_text(tool.reach()), size_text(environment),
                             is_mesh ? "" : "are the tool's lengths in metres, or ", question)};
}

}  // namespace

std::optional<Warning> short_path_warning(const DragHandFields& fields, const DragHand& hand, double duration,
                                          const ToolShape& tool) {
  const double path = hand.path().length(), to_cover = way_to_cover(fields, duration);
  // By less than the tool is wide it is the edge that ends the way.
  if (to_cover <= path + 2.0 * tool.half_width()) return std::nullopt;
  const std::string ends =
      fmt::format("the path of the drag ends after {} of {}: ", length_text(path), length_text(to_cover));
  return Warning{"short_path", "",
                 ends + (fields.path ? "hand.path_m leads no further over the surface; let its points lie on it"
                                     : "beyond, the surface ends or turns against hand.direction; another "
                                       "initial.position_m, a larger hand.smoothing_m or hand.path_m leads further")};
}

std::string scale_question(const Scenario& scenario, const ToolShape& tool, const Box& environment) {
  // Scenes are made of tools and places to work on. An environment this much smaller than the tool is thick, or larger
  // than it is long, is suspect, and millimetres taken for metres change either a thousandfold.
  constexpr double kTooSmall = 0.1, kTooLarge = 100.0;
  const double size = diagonal(environment);
  if (size >= kTooSmall * 2.0 * tool.half_width() && size <= kTooLarge * tool.reach()) return "";
  if (std::holds_alternative<MeshToolFields>(scenario.tool)) return "are tool.scale and the environment's size right?";
  return size_question(scenario.environment);
}

std::string odd_frame(const Box& tool) {
  constexpr double kOdd = 2.0;  // as far this way as the other, or further, is not an accident
  const Vec3 size = tool.size();
  const double gap = distance_to(tool, Vec3::Zero());
  if (gap > 0.0) return fmt::format("lies {} away from its tip centre", length_text(gap));
  const auto [short_side, long_side] = std::minmax(size.x(), size.y());
  if (long_side > kOdd * std::max(short_side, size.z())) return "lies across its axis";
  if (-tool.min.z() > kOdd * tool.max.z()) return "lies before its tip centre, not behind";
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

SceneFacts scene_facts(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  SceneFacts facts;
  const auto warn = [&facts](std::optional<Warning> warning) {
    if (warning) facts.warnings.push_back(std::move(*warning));
  };
  const double step = scenario.time.step;
  if (step > kUnitsApart * kUsualStep || kUnitsApart * step < kUsualStep)
    warn(
        Warning{"step", "/time/step_s", fmt::format("{:.3g} s; haptic loops step each 1 ms: is it in seconds?", step)});
  const ToolShape& tool = *(facts.tool = make_tool(scenario, loaded.files));
  for (Warning& warning : tool_warnings(scenario.rendering, tool)) warn(std::move(warning));
  const auto shell = make_shell(scenario, loaded.files);
  throw_if_stopped();  // that may have taken seconds
  if (!shell || shell->size() == 0) return facts;
  if (std::holds_alternative<MeshEnvironment>(scenario.environment))
    facts.is_closed = loaded.files.at(kEnvironmentFile).mesh().open_edges().empty();
  const SimulationParts parts = assemble(scenario, loaded.files, shell, {});
  if (const auto* hand = dynamic_cast<const DragHand*>(parts.hand.get())) {
    const double duration = step * static_cast<double>(scenario.time.steps);
    warn(short_path_warning(std::get<DragHandFields>(scenario.hand), *hand, duration, tool));
  }
  const ToolPose pose = first_pose(scenario, parts);
  const Gap gap = gap_between(tool, pose, *shell);
  const auto& surface = facts.surface.emplace(SceneFacts::Surface{shell->bounds(), shell->size(), gap});
  if (surface.box.min != surface.box.max) {  // a single point has no size
    if (const auto scale = scale_warning(scenario, tool, surface.box)) {
      warn(scale);
    } else {
      warn(size_warning(scenario.environment, surface.box));
      warn(spacing_warning(loaded, tool));
    }
    warn(start_warning(tool, surface));
    if (std::holds_alternative<RecordedPosition>(scenario.motion.position)) {
      for (Warning& warning : stroke_warnings(*loaded.files.at(kMotionFile).stroke(), scenario.time, tool, surface.box))
        warn(std::move(warning));
    }
  }
  warn(wrong_side_warning(*shell, tool, pose));
  return facts;
}

double script_moves_until(const Scenario& scenario) {
  const HandFields& hand = scenario.hand;
  const bool is_led = scripts_of(hand).empty() && !std::holds_alternative<NoHandFields>(hand);
  return is_led || !scenario.motion.orientation ? kAlways : largest(scenario, moves_until);
}

double script_period(const Scenario& scenario) {
  return largest(scenario, period_of);
}

bool is_moved(const Scenario& scenario) {
  const ImpedanceHandFields* hand = spring_of(scenario.hand);
  return script_moves_until(scenario) > 0.0 || (hand != nullptr && hand->tremor);
}

std::optional<PointDistance> point_distance(const LoadedScenario& loaded) {
  const Environment& environment = loaded.scenario.environment;
  constexpr const char* kSpacing = "environment.spacing_m";
  if (const auto* block = std::get_if<BlockEnvironment>(&environment))
    return PointDistance{"environment.grid_m", block->grid};
  const auto* mesh = std::get_if<MeshEnvironment>(&environment);
  if (mesh != nullptr && !mesh->spacing) {
    const double distance = vertex_distance(loaded.files.at(kEnvironmentFile).mesh().triangles());
    return PointDistance{kSpacing, distance, false};
  }
  return std::visit(
      [](const auto& shape) -> std::optional<PointDistance> {
        if constexpr (requires { shape.spacing; })
          return PointDistance{kSpacing, std::optional<double>(shape.spacing).value()};
        return std::nullopt;
      },
      environment);
}

Gap gap_between(const ToolShape& tool, const ToolPose& pose, const PointShell& shell) {
  constexpr std::size_t kAtOnce = 4096;  // keeps the buffer small, however large the shell
  ContactBuffer points(std::min(kAtOnce, shell.size()));
  Gap gap{std::numeric_limits<double>::infinity()};
  for (std::size_t first = 0; first < shell.size(); first += kAtOnce) {
    points.clear();
    for (std::size_t i = first; i < std::min(first + kAtOnce, shell.size()); ++i) {
      const SurfacePoint point = shell.point(i);
      points.push(static_cast<std::uint32_t>(i), point.position, point.normal);
    }
    tool.surface_constraints(pose, Vec3::Zero(), 0.0, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      gap.distance = std::min(gap.distance, -points.depth[i]);
      if (points.depth[i] >= 0.0) ++gap.touching;
    }
  }
  return gap;
}

std::string length_text(double metres) {
  const Unit unit = unit_for(metres);
  return fmt::format("{:.3g} {}", metres * unit.per_metre, unit.name);
}

std::string size_text(const Box& box) {
  const Unit unit = unit_for(box.size().maxCoeff());
  const Vec3 n = box.size() * unit.per_metre;
  return fmt::format("{:.3g} x {:.3g} x {:.3g} {}", n.x(), n.y(), n.z(), unit.name);
}

std::string place_text(const Box& box) {
  const Unit unit = unit_for(std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff()));
  const Vec3 a = box.min * unit.per_metre, b = box.max * unit.per_metre;
  return fmt::format("x {:.3g} ... {:.3g}, y {:.3g} ... {:.3g}, z {:.3g} ... {:.3g} {}", a.x(), b.x(), a.y(), b.y(),
                     a.z(), b.z(), unit.name);
}

}  // namespace hapbench
