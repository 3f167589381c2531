#pragma once

#include <cstddef>
#include <string>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Levels of a field, from the scenario's value to finer ones: h, h/r, h/r^2, …
namespace hapbench {

inline constexpr const char* kStepPath = "time.step_s";

/// The levels of a scene's field, from the scenario's own value to finer ones.
struct LevelSweep {
  Axis axis;                  ///< the field's values, with what has to change along with them
  double ratio = 2.0;         ///< of each value to the next
  double formal_order = 2.0;  ///< of the integrator, or of whatever a distance between points or of a grid approximates
  std::string no_order = {};  ///< why no metric of this scene can have an order; empty otherwise
};

/// With shorter steps the run lasts as long, delays of devices keep their length, and metrics of motion, force and
/// contact are taken at the times of the coarsest rows. A mesh without a spacing begins with the mean distance of its
/// vertices. Throws InputError when the field is not a number > 0 or an integer, and for a ratio of steps that is not
/// whole.
LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio);

/// The cases at the levels behind the first. Throws InputError where one of them cannot be run.
Cases finer_cases(const LevelSweep& levels, const Cases& cases);

}  // namespace hapbench
