#pragma once

#include <cstdint>
#include <memory>

#include "results/observe/step_times.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/simulation.hpp"

/// Runs without observers and files: the cost of the simulation alone.
namespace hapbench {

/// Returns the processor time of this thread [s]. Unlike wall time, it does not include waiting for other processes.
double processor_seconds();

/// A simulation of the first trial of a scenario, without observers. It can be repeated, and every repetition is
/// bitwise identical.
class BareRun {
 public:
  /// Builds the parts. Throws InputError if a file of the scenario cannot be used.
  BareRun(CheckedScenario checked, const std::shared_ptr<const PointShell>& shell);

  /// Takes all steps from t = 0 on, `times` times, and returns the processor time [s] of one repetition. Throws Stopped
  /// after a signal.
  double seconds(std::uint64_t times);
  /// Takes all steps once and returns the distribution of their wall times, without the time of the clock readings.
  StepLatency latency();
  /// Returns the number of steps of the last repetition. It is smaller than TimeFields::steps if the run diverged or
  /// its task ended.
  std::uint64_t steps() const { return simulation_.next_row(); }

 private:
  CheckedScenario checked_;
  Simulation simulation_;
};

}  // namespace hapbench
