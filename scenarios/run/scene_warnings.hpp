#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/trace_source.hpp"
#include "sim/tool/tool_shape.hpp"

/// Checks a scene for likely mistakes before it runs. Returns warnings, and questions that name the field that
/// is probably wrong.
namespace hapbench {

/// Limits of the longest edge of an object that a hand works on [m]. A length outside of these limits probably
/// has a wrong unit.
inline constexpr double kShortestObject = 0.001, kLongestObject = 1.0;

/// Returns the path length [m] along which the hand would drag the tool in `duration` [s] if the surface did not
/// end. Along a direction, this length is speed times duration. Along given points, it is at most the path length
/// to the last point.
inline double intended_drag_length(const DragHandFields& hand, double duration) {
  return std::min(hand.drag.speed * duration, drag_length(hand, duration));
}

/// Returns a warning if the path of a drag over the surface is shorter than intended_drag_length() in `duration` [s] by
/// more than the tool's width. The warning gives the path length and suggests what to change. The path of the drag is
/// computed before the run.
std::optional<Warning> short_path_warning(const DragHandFields& fields, const DragHand& hand, double duration,
                                          const ToolShape& tool);

/// Returns a question about the field that determines the size of the environment, such as its scale.
const char* size_question(const Environment& environment);

/// Returns a question about the field that is most likely wrong if the sizes of tool and environment are out of
/// proportion; otherwise an empty text.
std::string scale_question(const Scenario& scenario, const ToolShape& tool, const Box& environment);

/// Returns a question about normals that may point to the wrong side, with the place where they are reversed. Empty if
/// the program knows the outside of the environment.
std::string normals_question(const Environment& environment, const NamedFiles& files);

/// Returns a warning if the sizes of a contact trace are probably in a wrong unit: a contact is deeper than the tool's
/// length, or the points span more than kLongestObject.
std::optional<Warning> trace_size_warning(const ContactTrace& trace, const ToolShape& tool);

/// Returns a text that describes an unusual position or orientation of a tool in the tool frame, such as "is longer
/// across its axis than along it". Empty if nothing is unusual. `tool`: bounding box of the tool in the tool frame, in
/// which the tip centre is the origin and the tip points along -z.
std::string frame_problem(const Box& tool);

/// Returns a warning if the proxy algorithm renders a tool that is not convex, because it keeps points out of convex
/// tools only. Also returns a warning if a mesh tool has a frame_problem().
std::vector<Warning> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool);

}  // namespace hapbench
