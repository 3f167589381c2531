#include "results/metrics/passivity_observer.hpp"

namespace hapbench {

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
