#pragma once

#include <cstdint>
#include <memory>

#include "results/observe/step_times.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"

/// Measures the run time of a simulation that has no observers and writes no files.
namespace hapbench {

/// Returns the processor time of this thread [s]. Unlike wall time, it does not include waiting for other processes.
double processor_seconds();

/// A simulation of the first trial of a scenario, without observers. It can be repeated, and every repetition is
/// bitwise identical.
class BareRun {
 public:
  /// Builds the parts. Throws InputError if a file of the scenario cannot be used.
  BareRun(CheckedScenario checked, const std::shared_ptr<const PointShell>& shell);

  /// Runs the simulation `times` times from t = 0, and returns the mean processor time of a run [s]. Throws Stopped
  /// after a signal.
  double seconds(std::uint64_t times);
  /// Runs the simulation once from t = 0, and returns the distribution of the wall times of the steps. The duration of
  /// a clock reading is subtracted from the time of each step.
  StepLatency latency();
  /// Returns the number of steps of the last run. The number is smaller than TimeFields::steps if the run diverged or
  /// its task ended.
  std::uint64_t steps() const { return simulation_.next_row(); }

 private:
  CheckedScenario checked_;
  Simulation simulation_;
};

}  // namespace hapbench
