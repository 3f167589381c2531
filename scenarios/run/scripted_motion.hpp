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
/// Returns true if a script or the hand's tremor moves the tool. Such a tool may never come to rest. MotionClassifier
/// therefore judges only the part of its velocity at frequencies above 30 Hz; after the end of the script, also the
/// whole velocity.
bool has_scripted_motion(const Scenario& scenario);

}  // namespace hapbench
