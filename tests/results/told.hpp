#pragma once

#include <optional>
#include <string_view>

#include "results/observe/metric_observer.hpp"

namespace hapbench {

/// The metrics of an observer, named without a section.
inline MetricList told(const MetricObserver& observer) {
  MetricList list;
  Section section(list, "");
  observer.tell(section);
  return list;
}

/// One number of it; none when the metric has no value.
inline std::optional<double> told(const MetricObserver& observer, std::string_view name) {
  return number_of(told(observer), name);
}

}  // namespace hapbench
