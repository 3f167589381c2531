#pragma once

#include <optional>
#include <vector>

#include "results/io/columns.hpp"
#include "sim/loop/observed_energy.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Tells whether a run's rendering was passive: extremes of its observed energy E (sim/loop/observed_energy.hpp).
struct PassivityMetrics {
  double energy_min = 0.0;   ///< least E of a row [J]; negative when the rendering gave more than it had
  double time_of_min = 0.0;  ///< of the first row that has it [s]
  double energy_end = 0.0;   ///< E of the last row [J]
  /// Energy that the rendering created, max(0, -energy_min) [J]; NaN if any rendered force was NaN.
  double net_created() const noexcept { return energy_min >= 0.0 ? 0.0 : -energy_min; }
};

/// The metrics have no value without rows.
MetricList metric_list(const std::optional<PassivityMetrics>& passivity);

/// Returns the metrics of the run that created the most energy, the first of equals; nothing if no run has rows.
std::optional<PassivityMetrics> merged(const std::vector<std::optional<PassivityMetrics>>& runs) noexcept;

/// Observes every row, in constant memory; about 100 ns a row with a turning moment, 4 ns without force.
class PassivityObserver final : public Observer {
 public:
  /// `dt`: time from row to row [s]; `position_is_free`: the motion is not prescribed.
  explicit PassivityObserver(double dt, bool position_is_free = true) : observed_(dt, position_is_free) {}

  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// Metrics of the rows seen so far; nothing before the first.
  std::optional<PassivityMetrics> metrics() const noexcept;

 private:
  ObservedEnergy observed_;
  bool rows_ = false;
  PassivityMetrics metrics_;
};

}  // namespace hapbench
