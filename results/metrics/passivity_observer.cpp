#include "results/metrics/passivity_observer.hpp"

namespace hapbench {

void PassivityObserver::on_step(const StepRecord& record) noexcept {
  if (observed_.rests(record.force.rendered, record.springs)) return observed_.rest(record.tool);
  observed_.move(record.tool);
  observed_.answer(record.tool, record.force.rendered, record.springs);
  const double energy = observed_.energy();
  if (rows_ && !(energy < metrics_.energy_min)) return;
  metrics_.energy_min = energy;
  metrics_.time_of_min = record.time;
  rows_ = true;
}

std::optional<PassivityMetrics> PassivityObserver::metrics() const noexcept {
  if (!rows_) return std::nullopt;
  PassivityMetrics metrics = metrics_;
  metrics.energy_end = observed_.energy();
  return metrics;
}

std::optional<PassivityMetrics> merged(const std::vector<std::optional<PassivityMetrics>>& runs) noexcept {
  std::optional<PassivityMetrics> least;
  for (const auto& run : runs) {
    if (run && (!least || run->energy_min < least->energy_min)) least = run;
  }
  return least;
}

}  // namespace hapbench
