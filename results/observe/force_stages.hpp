#pragma once

#include <cstdint>

#include "results/observe/metric_observer.hpp"

namespace hapbench {

/// Counts what dry friction (algorithms/stages/damping_and_limits.hpp) does: whether the tool goes by sticking or by
/// sliding. Constant memory.
class FrictionObserver final : public MetricObserver {
 public:
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

 private:
  double dt_ = 0.0;
  std::uint64_t rows_ = 0, sticking_ = 0, sliding_ = 0, slips_ = 0;
  Friction last_ = Friction::none;
};

/// Reads how much a force stage changes the force of its algorithm, from the algorithm's work in every row.
class ForceStageObserver final : public MetricObserver {
 public:
  void begin(const TrialParts& trial) override;
  void on_step(const StepRecord&) noexcept override {
    ++rows_;
    work_ = algorithm_->work();
  }
  void tell(Section& section) const override;

 private:
  const ForceAlgorithm* algorithm_ = nullptr;
  std::uint64_t rows_ = 0;
  AlgorithmWork work_;
};

}  // namespace hapbench
