#pragma once

#include <optional>
#include <vector>

#include "sim/loop/observed_energy.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Whether a run's rendering was passive: its observed energy (sim/loop/observed_energy.hpp) over the rows.
struct PassivityMetrics {
  double energy_min = 0.0;   ///< least E of a row [J]; negative when the rendering gave more than it had
  double time_of_min = 0.0;  ///< of the first row that has it [s]
  double energy_end = 0.0;   ///< E of the last row [J]
  /// Energy the rendering made from nothing [J]; NaN when it made numbers that are none.
  double net_created() const noexcept { return energy_min >= 0.0 ? 0.0 : -energy_min; }
};

/// Of several runs: the one that created most, the first of equals. None without runs that have rows.
std::optional<PassivityMetrics> merged(const std::vector<std::optional<PassivityMetrics>>& runs) noexcept;

/// Observes every row, in constant memory; about 100 ns a row with a turning moment, 4 ns without force.
class PassivityObserver final : public Observer {
 public:
  /// `dt`: time from row to row [s].
  explicit PassivityObserver(double dt) : observed_(dt) {}

  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// Of the rows so far; none without any.
  std::optional<PassivityMetrics> metrics() const noexcept;

 private:
  ObservedEnergy observed_;
  bool rows_ = false;
  PassivityMetrics metrics_;
};

}  // namespace hapbench
