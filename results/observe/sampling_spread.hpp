#pragma once

#include <vector>

#include "results/observe/metrics.hpp"

namespace hapbench {

/// For a run in which only every n-th step counts: estimates how much the choice of the first counted step changes the
/// metrics.
/// The step with the largest force, or the step of a landing, can lie between two counted steps; a slightly different
/// time step then moves it to another counted step, and the metric jumps. Measures the metrics for up to four choices.
class SamplingSpread {
 public:
  /// `dt`, `config`: the arguments of the run's MetricsObserver. Observes nothing if every step counts.
  SamplingSpread(double dt, MetricsConfig config);

  /// Begins the next trial.
  void begin() noexcept;
  /// Returns the observers of the other choices.
  std::vector<MetricsObserver>& observers() noexcept { return others_; }
  /// Writes Metric::sampling_spread of the metrics of MetricsObserver in `list`: the range of the values over the m
  /// choices, times m / (m - 1). Reason for the factor: a value may increase in proportion to the first counted step
  /// and then jump back; m evenly spaced choices show the fraction (m - 1) / m of the range of this value.
  void write(MetricList& list) const;

 private:
  std::vector<MetricsObserver> others_;
};

}  // namespace hapbench
