#pragma once

#include <cstdint>

#include "results/io/columns.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// The torque on the tool that a device of three degrees of freedom cannot render.
struct LostTorqueMetrics {
  std::uint64_t rows_in_contact = 0;  ///< rows with a colliding point
  double mean = 0.0;                  ///< mean ||tau|| of these rows [N m]; 0 without any
  double max = 0.0;                   ///< largest ||tau|| of a row [N m]
};

MetricList metric_list(const LostTorqueMetrics& torque);

/// Observes the lost torque (thesis Fig. 1), tau = sum r_i x f_i about the tip centre, where f_i is the contribution of
/// contact i to f_spring (SpringState::moment) and r_i its place relative to the tip centre. A device of three degrees
/// of freedom renders sum f_i and no torque. Constant memory, a nanosecond a row.
class LostTorqueObserver final : public Observer {
 public:
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// The metrics of the rows seen so far.
  LostTorqueMetrics metrics() const noexcept;

 private:
  std::uint64_t rows_in_contact_ = 0;
  double sum_ = 0.0;
  double max_squared_ = 0.0;
};

}  // namespace hapbench
