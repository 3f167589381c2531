#include "results/observe/force_stages.hpp"

namespace hapbench {

void FrictionObserver::on_step(const StepRecord& record) noexcept {
  const Friction now = record.force.friction;
  ++rows_;
  sticking_ += now == Friction::sticks ? 1 : 0;
  sliding_ += now == Friction::slides ? 1 : 0;
  slips_ += now == Friction::slides && last_ == Friction::sticks ? 1 : 0;
  last_ = now;
}

FrictionMetrics FrictionObserver::metrics() const noexcept {
  FrictionMetrics metrics;
  metrics.rows_with_load = sticking_ + sliding_;
  if (metrics.rows_with_load > 0)
    metrics.stick_share = static_cast<double>(sticking_) / static_cast<double>(metrics.rows_with_load);
  if (rows_ > 0) metrics.slips_per_s = static_cast<double>(slips_) / (dt_ * static_cast<double>(rows_));
  return metrics;
}

MetricList metric_list(const FrictionMetrics& m) {
  return {{"stick_share", "1", "share of the rows with load in which dry friction sticks",
           if_any(m.rows_with_load > 0, m.stick_share)},
          {"slips_per_s", "1/s", "times that a sticking tool began to slide, per second of the run",
           if_any(m.rows_with_load > 0, m.slips_per_s)}};
}

}  // namespace hapbench
