#pragma once

#include <optional>
#include <vector>

#include "scenarios/scene/scenario.hpp"

/// Finds out whether, and until when, scripts move the hand or turn the tool.
namespace hapbench {

/// Returns the time until which a script moves the hand or turns the tool [s]; 0 if there is no such script. Infinite
/// if a script never stops, or if a drag, a simulated subject or a recorded stroke moves the tool.
double script_moves_until(const Scenario& scenario);
/// Returns the periods of the periodic scripts of hand and tool [s]; empty if no script is periodic.
std::vector<double> script_periods(const Scenario& scenario);
/// Returns the longest of script_periods() [s]; 0 if no script is periodic.
double script_period(const Scenario& scenario);
/// Returns how often a script may lift the tool off a surface: once for each period or waypoint of the script of the
/// hand's force or target, and twice for each period or waypoint of a script of the orientation. Empty if the number is
/// unknown, because the hand has a tremor or is a simulated subject.
std::optional<double> scripted_lifts(const Scenario& scenario);
/// Returns true if script_moves_until() is above 0, or if the hand has a tremor. Such a tool may never come to rest.
/// While the script moves, MotionClassifier therefore judges only the part of the tool's velocity above 30 Hz. After
/// the end of the script, it judges the whole velocity too.
bool has_scripted_motion(const Scenario& scenario);

}  // namespace hapbench
