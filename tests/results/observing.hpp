#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "results/observe/metric_observer.hpp"

// Step records for tests of observers, and access to the metrics that observers report.

namespace hapbench::test {

/// Returns the record of a step with a tool at rest at the origin and no force. `contacts` must outlive the record.
inline StepRecord row(std::uint64_t step, double time, const ContactBuffer& contacts) {
  StepRecord r;
  r.step = step;
  r.time = time;
  r.colliding = contacts.size();
  r.rendered = &contacts;
  return r;
}

/// Returns padded contacts with these gradients. Their shell indices are 10, 11, …, their depths 1 mm, their weights 1,
/// and their positions (0.5, 0.25, 0) m.
inline ContactBuffer contacts_along(const std::vector<Vec3>& gradients) {
  ContactBuffer contacts(gradients.size());
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    contacts.push(static_cast<std::uint32_t>(10 + i), {0.5, 0.25, 0.0}, -gradients[i]);
    contacts.depth[i] = 0.001;
    contacts.set_gradient(i, gradients[i]);
    contacts.weight[i] = 1.0;
  }
  contacts.pad();
  return contacts;
}

}  // namespace hapbench::test

namespace hapbench {

/// Returns the metrics of an observer. Their names have no section prefix.
inline MetricList reported(const MetricObserver& observer) {
  MetricList list;
  Section section(list, "");
  observer.report(section);
  return list;
}

/// Returns the value of the observer's metric with this name; empty if the metric has no value.
inline std::optional<double> reported(const MetricObserver& observer, std::string_view name) {
  return number_of(reported(observer), name);
}

}  // namespace hapbench
