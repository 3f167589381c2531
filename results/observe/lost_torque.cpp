#include "results/observe/lost_torque.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {

void LostTorqueObserver::on_step(const StepRecord& record) noexcept {
  const double squared = record.springs.moment.squaredNorm();
  max_squared_ = std::max(max_squared_, squared);
  if (record.colliding == 0) return;
  ++rows_in_contact_;
  sum_ += std::sqrt(squared);
}

LostTorqueMetrics LostTorqueObserver::metrics() const noexcept {
  const double mean = rows_in_contact_ > 0 ? sum_ / static_cast<double>(rows_in_contact_) : 0.0;
  return {rows_in_contact_, mean, std::sqrt(max_squared_)};
}

}  // namespace hapbench
