#include "results/observe/sampling_spread.hpp"

#include <algorithm>

namespace hapbench {

SamplingSpread::SamplingSpread(double dt, MetricsConfig config) {
  constexpr std::uint64_t kMaxChoices = 4;
  const std::uint64_t choices = std::min(config.stride, kMaxChoices);
  for (std::uint64_t i = 1; i < choices; ++i) {
    config.first = i * config.stride / choices;
    others_.emplace_back(dt, config);
  }
}

void SamplingSpread::begin() noexcept {
  for (MetricsObserver& other : others_) other.begin();
}

void SamplingSpread::write(MetricList& list) const {
  if (others_.empty()) return;
  // Compute the metrics for the other choices of the first counted step.
  std::vector<MetricList> lists;
  for (const MetricsObserver& other : others_) {
    Section section(lists.emplace_back(), "");
    other.report(section);
    other.report_end(section);
  }
  const auto choices = static_cast<double>(others_.size() + 1);
  for (Metric& metric : list) {
    const std::optional<double> value = number_of(list, metric.name);
    if (!value || find_metric(lists.front(), metric.name) == nullptr) continue;
    double smallest = *value, largest = *value;
    for (const MetricList& other : lists) {
      const std::optional<double> number = number_of(other, metric.name);
      if (!number) continue;
      smallest = std::min(smallest, *number);
      largest = std::max(largest, *number);
    }
    metric.sampling_spread = (largest - smallest) * choices / (choices - 1.0);
  }
}

}  // namespace hapbench
