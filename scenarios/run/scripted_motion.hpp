#pragma once

#include "scenarios/scene/scenario.hpp"

/// Who moves the tool of a scenario.
namespace hapbench {

/// The time until which a script moves the hand or turns the tool [s]: 0 if it never does, infinite if it never stops.
double script_moves_until(const Scenario& scenario);
/// The longest period of what repeats in the scripts of hand and tool [s]; 0 where nothing does.
double script_period(const Scenario& scenario);
/// True when a script moves the hand or turns the tool: then the tool never comes to rest, and only what is above 30 Hz
/// and 1 mm/s counts as motion, and once the script has ended all beyond 1 mm/s. A hand that trembles also moves it.
bool is_moved(const Scenario& scenario);

}  // namespace hapbench
