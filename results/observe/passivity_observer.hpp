#pragma once

#include <optional>

#include "results/observe/metric_observer.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

/// Tells whether a run's rendering was passive: extremes of its observed energy E (sim/loop/observed_energy.hpp). Of
/// several trials it tells those of the one that created the most energy, the first of equals. Constant memory; about
/// 100 ns a row with a turning moment, 4 ns without force.
class PassivityObserver final : public MetricObserver {
 public:
  /// `dt`: time from row to row [s]; `position_is_free`: the motion is not prescribed. `begin` sets both.
  explicit PassivityObserver(double dt = 0.0, bool position_is_free = true) : observed_(dt, position_is_free) {}

  void begin(const TrialParts& trial) override;
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

  /// E of the last row with a force or a moment [J]; nothing before it.
  std::optional<double> energy() const noexcept { return if_any(now_.rows, observed_.energy()); }
  /// Energy that the rendering created in the trial that was begun last, max(0, -E_min) [J]; NaN if any rendered force
  /// was NaN.
  double net_created() const noexcept { return now_.net_created(); }

 private:
  struct Extremes {
    bool rows = false;         ///< a row had a force or a moment
    double energy_min = 0.0;   ///< least E of a row [J]; negative when the rendering gave more than it had
    double time_of_min = 0.0;  ///< of the first row that has it [s]
    double energy_end = 0.0;   ///< E of the last row [J], once the trial has ended
    double net_created() const noexcept { return energy_min >= 0.0 ? 0.0 : -energy_min; }
  };
  Extremes worst() const noexcept;

  ObservedEnergy observed_;
  Extremes now_, worst_before_;  ///< of this trial, and the worst of the earlier ones
};

}  // namespace hapbench
