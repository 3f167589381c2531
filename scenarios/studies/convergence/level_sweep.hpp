#pragma once

#include <string>
#include <vector>

#include "scenarios/batch/run_sweep.hpp"
#include "scenarios/studies/convergence/order.hpp"

/// Convergence studies as sweeps of one field over levels of refinement.
namespace hapbench {

inline constexpr const char* kStepPath = "time.step_s";

/// The levels of a scene's field, from the scenario's own value to finer ones.
struct LevelSweep {
  Axis axis;                  ///< the field's values, with what has to change along with them
  double ratio = 2.0;         ///< of each value to the next
  double formal_order = 2.0;  ///< of the integrator, or of whatever a distance between points or of a grid approximates
  std::string no_order;       ///< why no metric of this scene can have an order; empty otherwise
};

/// The levels of a field. With shorter steps the run lasts as long, delays of devices keep their length, and metrics of
/// motion, force and contact are taken at the times of the coarsest rows. A mesh without a spacing begins with the mean
/// distance of its vertices; with `as_it_is` with its own vertices. Throws InputError when the field is no number > 0
/// or an integer, and for a ratio of steps that is not whole.
LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio,
                       bool as_it_is = false);

/// The metric of a level's run; none where it has none, diverges or could not be computed.
std::optional<double> level_result(const SweepPlan& plan, const SweepRow& row, const std::string& metric);

/// The verdict on a metric of the plan, of as many rows as the axis has levels.
Convergence convergence_of(const LevelSweep& levels, const SweepPlan& plan, std::span<const SweepRow> rows,
                           const std::string& metric);

}  // namespace hapbench
