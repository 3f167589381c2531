#pragma once

#include <optional>
#include <string>

#include "results/observe/approach.hpp"
#include "results/observe/metrics.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/run/drag_course.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// What a run that did all its steps had to do with the environment.
struct Encounter {
  const Metrics& metrics;
  const Approach& approach;
  const Box& environment;  ///< around all points of the shell
  const ToolShape& tool;
  std::optional<DragCourse> drag = {};  ///< of a hand that drags
};

/// The outcome of a run that completed, once it is known what it touched: `no_contact` when no row had a colliding
/// point; `lost_contact` when a tool that moves freely ended further from the environment's box than the box is wide
/// and the tool reaches together, as one does that was thrown out or pushed past, or when a dragged tool lost the
/// surface; `not_dragged` when one came nowhere (DragCourse): it was pressed, and its calm numbers tell nothing of a
/// drag; else `completes`.
Outcome outcome_of(const Scenario& scenario, const Encounter& encounter);

/// For a tool from a mesh whose size is out of proportion with the environment's, a question about its scale.
std::optional<std::string> scale_warning(const Scenario& scenario, const ToolShape& tool, const Box& environment);

/// For those two outcomes, what happened and what the likely cause is; none for others, and none for a dragged tool
/// that lost the surface within the environment's box, of which drag_warnings tells.
std::optional<std::string> warning_about(const Scenario& scenario, Outcome outcome, const Encounter& encounter);

}  // namespace hapbench
