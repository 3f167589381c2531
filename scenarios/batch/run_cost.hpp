#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "results/observe/step_times.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/run/checked_scenario.hpp"

/// Measures the cost of scenarios with bare runs: without observers and files.
namespace hapbench {

/// Processor time of a run, without the preparation of its point shell.
struct RunCost {
  std::uint64_t steps = 0;   ///< steps of the run
  double step_s = 0.0;       ///< processor time of one step [s]: mean over a run, in the fastest repetition
  double spread_s = 0.0;     ///< median over the repetitions minus step_s [s]
  double time_step_s = 0.0;  ///< simulated time of one step [s]

  /// Processor time per simulated second [1].
  double per_simulated_second() const { return step_s / time_step_s; }
  /// Processor time of one step as a fraction of the deadline of 0.5 ms.
  double deadline_share() const { return step_s / kStepDeadlines[0]; }
};

/// Returns true if `a` is faster than `b` by more than the sum of both spreads.
bool is_faster(const RunCost& a, const RunCost& b);

/// Default number of measurements of each scenario.
inline constexpr unsigned kTimingRepetitions = 5;

/// Measures the cost of `count` scenarios, one run at a time. `scene` returns scenario i.
///
/// Every round measures each scenario once, so that a slow change of the processor's speed affects all scenarios alike.
/// A measurement repeats a short run until about 20 ms have been measured, but at most 1000 times. The simulations of
/// all scenarios stay in memory until the end; scenarios with equal environments share a point shell. `jobs` only
/// supplies label and listener of the progress bar. Throws InputError and Stopped.
std::vector<RunCost> measure_cost(std::size_t count, const std::function<CheckedScenario(std::size_t)>& scene,
                                  const JobOptions& jobs, unsigned repetitions = kTimingRepetitions);

}  // namespace hapbench
