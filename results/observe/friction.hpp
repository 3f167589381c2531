#pragma once

#include <cstdint>

#include "results/io/columns.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// How a tool under dry friction goes: by sticking or by sliding.
struct FrictionMetrics {
  std::uint64_t rows_with_load = 0;  ///< rows in which friction sticks or slides
  double stick_share = 0.0;          ///< share of these in which it sticks
  double slips_per_s = 0.0;          ///< times that a sticking tool began to slide, per second of the run
};

MetricList metric_list(const FrictionMetrics& friction);

/// Counts what dry friction (algorithms/stages/damping_and_limits.hpp) does. Constant memory.
class FrictionObserver final : public Observer {
 public:
  explicit FrictionObserver(double dt) : dt_(dt) {}

  void on_step(const StepRecord& record) noexcept override;

  /// The metrics of the rows seen so far.
  FrictionMetrics metrics() const noexcept;

 private:
  double dt_;
  std::uint64_t rows_ = 0, sticking_ = 0, sliding_ = 0, slips_ = 0;
  Friction last_ = Friction::none;
};

}  // namespace hapbench
