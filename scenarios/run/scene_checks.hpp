#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The place of a tool against the points of a surface.
struct Gap {
  /// Distance of the tool from the nearest point [m]; when negative, how deep the deepest point lies in it.
  double distance = 0.0;
  std::size_t touching = 0;  ///< points in the tool
};

/// Facts about a scenario that are known before it runs.
struct SceneFacts {
  /// The points of the environment; springs have none.
  struct Surface {
    Box box;
    std::size_t points = 0;
    Gap start;  ///< where the tool starts
  };
  std::optional<Surface> surface;
  std::shared_ptr<const ToolShape> tool;
  std::optional<bool> is_closed;  ///< of a mesh
  std::vector<Warning> warnings;  ///< about the tool, and the way of its drag, in this scene
};

/// Builds the environment and places the tool. Throws InputError when a named file cannot be used.
SceneFacts scene_facts(const LoadedScenario& loaded);

// ---- Warnings about a scene. ----

/// Longest edges of what a hand works on, at least and at most [m]: those of others are likely of another unit.
inline constexpr double kShortestObject = 0.001, kLongestObject = 1.0;

/// The length of the way on which a scenario has the tool dragged in `duration` [s]: along a direction as far as the
/// time allows, along points at most to the last one [m].
inline double way_to_cover(const DragHandFields& hand, double duration) {
  return std::min(hand.drag.speed * duration, drag_length(hand, duration));
}

/// A warning for the path of a drag over the surface that falls short of the way to cover in `duration` [s] by more
/// than the tool is wide: how long it is and what to change. It is known before the run.
std::optional<Warning> short_path_warning(const DragHandFields& fields, const DragHand& hand, double duration,
                                          const ToolShape& tool);

/// A question about the likeliest field where the sizes of tool and environment are out of proportion; else empty.
std::string scale_question(const Scenario& scenario, const ToolShape& tool, const Box& environment);

/// The odd thing about the place of a tool that fills the box in its own frame, as "lies across its axis"; empty when
/// nothing is odd. Tools have their tip centre at the origin, and their tip points along -z.
std::string odd_frame(const Box& tool);

/// Warnings about a tool: a proxy keeps points out of convex tools only, and a mesh may lie oddly in its frame.
std::vector<Warning> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool);

// ---- Who moves the tool. ----

/// The time until which a script moves the hand or turns the tool [s]: 0 if it never does, infinite if it never stops.
double script_moves_until(const Scenario& scenario);
/// The longest period of what repeats in the scripts of hand and tool [s]; 0 where nothing does.
double script_period(const Scenario& scenario);
/// True when a script moves the hand or turns the tool: then the tool never comes to rest, and only what is above 30 Hz
/// and 1 mm/s counts as motion, and once the script has ended all beyond 1 mm/s. A hand that trembles also moves it.
bool is_moved(const Scenario& scenario);

/// What a handle may vibrate unless it is said otherwise [m/s rms above 30 Hz]. It is a speed because vibrations of the
/// hand from 16 to 400 Hz of equal speed are about equally unpleasant (Griffin, Industrial Health 50, 2012). Its value
/// is our choice, as of the classes of motion; a hand that holds a cylinder feels less than a hundredth of it at 150 to
/// 200 Hz (Brisben, Hsiao and Johnson, Journal of Neurophysiology 81, 1999).
inline constexpr double kMostVibration = 1e-3;

// ---- Points and distances. ----

/// The field that sets the distance of the shell's points, and this distance.
struct PointDistance {
  const char* path;  ///< of the field, as in --set
  double metres;
  bool is_given = true;  ///< false: the mean distance of the vertices of a mesh that is taken as it is
};

/// Empty where no field sets it.
std::optional<PointDistance> point_distance(const LoadedScenario& loaded);

/// Looks at all points of the shell, which has some.
Gap gap_between(const ToolShape& tool, const ToolPose& pose, const PointShell& shell);

/// The length of a box from corner to corner [m].
inline double diagonal(const Box& box) {
  return box.size().norm();
}

// ---- Quantities as people read them. ----

/// A length as people read it, with three significant digits and the unit that fits, as in "13.5 mm" or "17.5 m".
std::string length_text(double metres);

/// The edges of a box in one unit, as in "13.5 x 16.7 x 6.6 mm".
std::string size_text(const Box& box);
/// The place of a box in one unit, as in "x -6.74 ... 6.76, y -7.3 ... 9.4, z -3.3 ... 3.3 mm".
std::string place_text(const Box& box);

}  // namespace hapbench
