#pragma once

#include <cstddef>
#include <string>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Refinement levels of a field, such as the time step: h, h/r, h/r^2, …, with the scenario's value h and a ratio r.
namespace hapbench {

inline constexpr const char* kStepPath = "time.step_s";

/// The refinement levels of a field of a scene, coarsest first.
struct LevelSweep {
  Axis axis;                  ///< the field's values, and the overrides that each value needs
  double ratio = 2.0;         ///< r, ratio of each value to the next value
  double formal_order = 2.0;  ///< expected order of convergence in the time step; 2 for a point spacing
  std::string no_order = {};  ///< why metrics of this scene have no convergence order; empty if they can have an order
  bool has_noise = false;     ///< true if every level has another noise, so that differences of levels are no errors
};

/// Returns `levels` levels of the field at `path`, each finer by `ratio`.
///
/// If the field is the time step, the duration of the run, the delays [s] of devices, and period [s] and delay [s] of
/// multi-rate contacts stay constant, and metrics of motion, force and contact are sampled at the times of the coarsest
/// level. If the field is a mesh spacing that the scenario does not give, the first level is the mean distance between
/// neighbouring vertices. Throws InputError if the field is not a floating-point number > 0, or if the ratio of time
/// steps is not an integer.
LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio);

/// Returns the value of level i for messages: a number with six significant digits, other text unchanged.
std::string level_text(const LevelSweep& levels, std::size_t i);

/// Returns the cases at all levels except the first. Throws InputError if a case is not valid.
Cases finer_cases(const LevelSweep& levels, const Cases& cases);

}  // namespace hapbench
