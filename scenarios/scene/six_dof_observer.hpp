#pragma once

#include <optional>

#include "algorithms/six_dof/devices.hpp"
#include "results/observe/metric_observer.hpp"
#include "results/observe/six_dof_metrics.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Compares, in every step, the force of the scenario's law on a 3-DOF device with the force of a 6-DOF device
/// (algorithms/six_dof/devices.hpp). The scripted motion is the pose that the hand intends to reach. Both devices are
/// computed in static equilibrium, so neither time nor the simulated force affects the result. Allocates no memory
/// during the run. Each step takes about 0.1 ms to some ms of computing time.
class SixDofObserver final : public MetricObserver {
 public:
  SixDofObserver() = default;
  /// Precondition: the scenario has the field six_dof and outlives the observer.
  explicit SixDofObserver(const Scenario& scenario) : scenario_(&scenario) {}

  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;
  void report(Section& section) const override { metrics_.report(section); }

  /// Returns the comparison in the latest step.
  const SixDofRow& row() const noexcept { return row_; }

 private:
  const Scenario* scenario_ = nullptr;  ///< null in an object that only lists the metrics
  std::optional<six_dof::SixDofDevice> reference_;
  std::optional<six_dof::ThreeDofDevice> device_;
  Vec3 first_axis_ = Vec3::Zero();  ///< axis of the tool in the scripted motion at t = 0
  SixDofRow row_;
  SixDofMetrics metrics_;
};

}  // namespace hapbench
