#pragma once

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/loop/simulation.hpp"

/// Hands that hold the handle: description of their fields, and construction of the simulated hand.
namespace hapbench {

/// Describes the fields of `hand` with meaning, unit, range and default.
void describe(Fields& f, HandFields& hand);

/// Sets `parts.hand` and `parts.motion`. Some hands also control the tool's orientation, which is part of the
/// motion. `files` are the scenario's files. Precondition: `parts.shell` is set, unless the environment is
/// springs. Throws InputError if a recorded motion cannot be used.
void add_hand_and_motion(const Scenario& scenario, const NamedFiles& files, Trial trial, SimulationParts& parts);

}  // namespace hapbench
