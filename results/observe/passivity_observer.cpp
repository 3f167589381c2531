#include "results/observe/passivity_observer.hpp"

#include <cmath>

namespace hapbench {

void PassivityObserver::on_step(const StepRecord& record) noexcept {
  if (observed_.rests(record.force.rendered, record.springs)) return observed_.rest(record.tool);
  observed_.move(record.tool, record.handle_moves_tool);
  observed_.answer(record.tool, record.force.rendered, record.springs);
  const double energy = observed_.energy();
  // The negated comparison keeps a NaN as the minimum.
  if (rows_ && !(energy < metrics_.energy_min) && !std::isnan(energy)) return;
  if (std::isnan(metrics_.energy_min)) return;
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
    if (run && (!least || run->energy_min < least->energy_min || std::isnan(run->energy_min))) least = run;
    if (run && std::isnan(run->energy_min)) break;
  }
  return least;
}

MetricList metric_list(const std::optional<PassivityMetrics>& m) {
  const bool any = m.has_value();
  const PassivityMetrics p = m.value_or(PassivityMetrics{});
  return {{"energy_min_J", "J",
           "least observed energy of a row: what translation and rotation have put into the rendering; "
           "negative when it gave more than it had",
           if_any(any, p.energy_min)},
          {"time_of_min_s", "s", "time of the first row that has it", if_any(any, p.time_of_min)},
          {"energy_end_J", "J", "observed energy of the last row", if_any(any, p.energy_end)},
          {"net_created_J", "J", "energy that the rendering created, max(0, -energy_min_J)",
           if_any(any, p.net_created()), Better::less}};
}

}  // namespace hapbench
