#pragma once

#include <vector>

#include "results/observe/metrics.hpp"

namespace hapbench {

/// Estimates how much the metrics depend on the choice of the first counted step, in a run in which only every n-th
/// step counts (TimeFields::stride). The step with the largest force, or the step of a landing, can lie between two
/// counted steps. A slightly different time step can then move such an event from one counted step to another, and the
/// metric jumps. Measures the metrics for up to four choices of the first counted step.
class SamplingSpread {
 public:
  /// `dt`, `config`: the arguments of the run's MetricsObserver. If every step counts, there is nothing to observe, and
  /// observers() is empty.
  SamplingSpread(double dt, MetricsConfig config);

  /// Begins the next trial.
  void begin() noexcept;
  /// Returns one observer for each choice of the first counted step except step 0, the choice of the run's
  /// MetricsObserver.
  std::vector<MetricsObserver>& observers() noexcept { return others_; }
  /// Sets Metric::sampling_spread of each metric in `list` that MetricsObserver reports: the range of the values over
  /// the m choices of the first counted step, times m / (m - 1). Reason for the factor: a value may increase in
  /// proportion to the first counted step and then jump back. The values at m evenly spaced choices then have (m - 1) /
  /// m of the full range.
  void write(MetricList& list) const;

 private:
  std::vector<MetricsObserver> others_;
};

}  // namespace hapbench
