#pragma once

#include <vector>

#include "results/observe/metrics.hpp"

namespace hapbench {

/// Estimates how far the metrics of a run whose every n-th step counts depend on the choice of the first counted step.
/// The step with the largest force, or the step of a landing, can lie between two counted steps; a slightly different
/// time step then moves it to another counted step, and the metric jumps. Measures the metrics for up to four choices.
class SamplingSpread {
 public:
  /// `dt`, `config`: those of the run's MetricsObserver. Observes nothing if every step counts.
  SamplingSpread(double dt, MetricsConfig config);

  /// Begins the next trial.
  void begin() noexcept;
  /// Returns the observers of the other choices.
  std::vector<MetricsObserver>& observers() noexcept { return others_; }
  /// Writes Metric::sampling_spread of the metrics of MetricsObserver in `list`: the range over the m choices times
  /// m / (m - 1), the range of a value that changes in proportion to the first counted step and jumps back.
  void write(MetricList& list) const;

 private:
  std::vector<MetricsObserver> others_;
};

}  // namespace hapbench
