#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/description/scenario_text.hpp"

namespace hapbench {

/// A scenario run at several points, of a grid or a sample: all that is known, and checked, before the first run.
struct SweepPlan {
  ScenarioText scenario;
  std::vector<std::string> overrides;  ///< of all runs, as in --set; the points' come after them
  SweepPoints points;

  std::vector<std::string> warnings;  ///< of all runs, each once
  std::vector<std::string> metrics;   ///< that some run has
  /// For each run a number of its environment; equal for equal environments.
  std::vector<std::size_t> environments;
  std::size_t environment_count = 0;
  /// What the rows are a function of: scenario, overrides, points, hashes of the files the scenarios name, program.
  Json content;
  std::string definition;  ///< FNV-1a of the content, as 16 hexadecimal digits
};

/// Loads every run's scenario and reads the files they name, to find what is wrong before anything is run or written.
/// About 0.1 ms a run for each of `jobs` threads. `progress` allows a progress bar. Throws InputError, of several for
/// the run with the lowest number.
SweepPlan plan_sweep(ScenarioText scenario, std::vector<std::string> overrides, SweepPoints points, std::size_t jobs,
                     bool progress);

/// The scenario of one run. For several threads. Precondition: run < plan.points.size().
LoadedScenario scenario_of(const SweepPlan& plan, std::size_t run);

}  // namespace hapbench
