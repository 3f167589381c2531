#pragma once

#include <optional>

#include "scenarios/scene/scenario.hpp"

/// Finds out whether, and until when, scripts move the hand or turn the tool.
namespace hapbench {

/// Returns the time until which a script moves the hand or turns the tool [s]; 0 if no script moves them. Infinite if a
/// script never stops, or if a drag, a subject or a recorded stroke leads the tool.
double script_moves_until(const Scenario& scenario);
/// Returns the longest period of the periodic scripts of hand and tool [s]; 0 if no script is periodic.
double script_period(const Scenario& scenario);
/// Returns how often the script of the hand or its target may lift the tool off a surface: once for each period or
/// waypoint. Empty if the number is unknown, because a tremor or a subject leads the tool.
std::optional<double> scripted_lifts(const Scenario& scenario);
/// Returns true if a script or the hand's tremor moves the tool, which therefore may never come to rest. Then
/// only velocity above 30 Hz that exceeds 1 mm/s counts as motion. After the end of the script, any velocity
/// above 1 mm/s counts.
bool has_scripted_motion(const Scenario& scenario);

}  // namespace hapbench
