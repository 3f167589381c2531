#pragma once

#include <cstdint>

#include "sim/loop/observer.hpp"

namespace hapbench {

/// What a run's contacts would have turned the tool with, had the device six degrees of freedom.
struct LostTorqueMetrics {
  std::uint64_t rows_in_contact = 0;  ///< rows with a colliding point
  double mean = 0.0;                  ///< mean ||tau|| of these rows [N m]; 0 without any
  double max = 0.0;                   ///< largest ||tau|| of a row [N m]
};

/// The torque that is lost (thesis Fig. 1): tau = sum r_i x f_i about the tip centre, of the force f_i that each
/// rendered contact contributes to f_spring at its place r_i from the tip centre. A device of three degrees of freedom
/// renders sum f_i and no torque. What f_i is says SpringState::moment. Constant memory, a nanosecond a row.
class LostTorqueObserver final : public Observer {
 public:
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  /// Of the rows seen so far.
  LostTorqueMetrics metrics() const noexcept;

 private:
  std::uint64_t rows_in_contact_ = 0;
  double sum_ = 0.0;
  double max_squared_ = 0.0;
};

}  // namespace hapbench
