#pragma once

#include <memory>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/tool/motion.hpp"

/// Motions of a tool: their fields, and the motion that these say.
namespace hapbench {

/// The fields of `motion` with meaning, unit, range and default.
void describe(Fields& f, MotionFields& motion);

Orientation make_orientation(const OrientationFields& fields);

/// The scripted or recorded motion. `files` are those of the scenario. Throws InputError when a recording cannot be
/// used.
std::unique_ptr<Motion> make_motion(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
