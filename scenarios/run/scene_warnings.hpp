#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/tool/tool_shape.hpp"

/// What is odd about a scene before it runs: warnings, and questions about the field that is likely wrong.
namespace hapbench {

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

/// The question about the field that makes an environment as large as it is.
const char* size_question(const Environment& environment);

/// A question about the likeliest field where the sizes of tool and environment are out of proportion; else empty.
std::string scale_question(const Scenario& scenario, const ToolShape& tool, const Box& environment);

/// The odd thing about the place of a tool that fills the box in its own frame, as "lies across its axis"; empty when
/// nothing is odd. Tools have their tip centre at the origin, and their tip points along -z.
std::string odd_frame(const Box& tool);

/// Warnings about a tool: a proxy keeps points out of convex tools only, and a mesh may lie oddly in its frame.
std::vector<Warning> tool_warnings(const RenderingConfig& rendering, const ToolShape& tool);

}  // namespace hapbench
