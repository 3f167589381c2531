#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// A scenario run at several points, of a grid or a sample: what is known, and checked, before the first run. Its size
/// does not depend on the number of runs, but for the points (sweep_points.hpp).
struct SweepPlan {
  ScenarioText scenario;
  std::vector<std::string> overrides;  ///< of all runs, as in --set; the points' come after them
  SweepPoints points;

  std::vector<std::string> warnings;  ///< of the runs that were checked, each once
  std::vector<std::string> metrics;   ///< that some of them has
  /// What the rows are a function of: scenario, overrides, points, hashes of the files the scenarios name, program.
  Json content;
  std::string definition;  ///< FNV-1a of the content, as 16 hexadecimal digits
};

/// Most runs of a sample, and most values of a field of a grid, that are checked before the first run.
inline constexpr std::size_t kMostChecked = 1000;

/// The runs that are checked, in order: all when there are no more than kMostChecked. Of a longer grid those at its
/// edges from the first run and from the last one, where one field takes each of its values (kMostChecked of them, the
/// ends included); of a longer sample the first ones.
std::vector<std::size_t> runs_to_check(const SweepPoints& points);

/// Loads the scenarios of the runs to check and reads the files they name, to find what is wrong before anything is run
/// or written. About 0.1 ms a run for each of `jobs` threads. `progress` allows a progress bar. Throws InputError, of
/// several for the run with the lowest number.
SweepPlan plan_sweep(ScenarioText scenario, std::vector<std::string> overrides, SweepPoints points, std::size_t jobs,
                     bool progress);

/// The overrides of one run: the plan's and the point's. Precondition, here and below: run < plan.points.size().
std::vector<std::string> overrides_of(const SweepPlan& plan, std::size_t run);

/// The scenario of one run. For several threads. Throws InputError when it was not checked and is wrong.
LoadedScenario scenario_of(const SweepPlan& plan, std::size_t run);

}  // namespace hapbench
