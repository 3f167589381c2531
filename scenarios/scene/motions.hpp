#pragma once

#include <memory>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/tool/motion.hpp"

/// Motions of a tool: description of their fields, and construction of the motion.
namespace hapbench {

/// Describes the fields of `motion` with meaning, unit, range and default.
void describe(Fields& f, MotionFields& motion);

/// Returns the scripted orientation that `fields` describe. Its directions are normalised.
Orientation make_orientation(const OrientationFields& fields);

/// Returns the scripted or recorded motion of the tool. `files` are the scenario's files. Throws InputError if a
/// recording cannot be used.
std::unique_ptr<Motion> make_motion(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
