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

MetricList metric_list(const LostTorqueMetrics& m) {
  return {{"lost_mean_Nm", "Nm",
           "mean ||tau|| of the rows in contact; tau = sum r_i x f_i about the tip's centre is the torque that "
           "the rendered contacts would exert by their shares f_i of f_spring, and that is lost",
           if_any(m.rows_in_contact > 0, m.mean)},
          {"lost_max_Nm", "Nm", "largest ||tau|| of a row", if_any(m.rows_in_contact > 0, m.max)}};
}

}  // namespace hapbench
