#pragma once

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/loop/simulation.hpp"

/// Hands that hold the handle: their fields, and the hand that these say.
namespace hapbench {

/// The fields of `hand` with meaning, unit, range and default.
void describe(Fields& f, HandFields& hand);

/// Adds the hand and the motion, which some hands steer. `files` are those of the scenario. Precondition: the shell is
/// there. Throws InputError when a recorded motion cannot be used.
void add_hand_and_motion(const Scenario& scenario, const NamedFiles& files, Trial trial, SimulationParts& parts);

}  // namespace hapbench
