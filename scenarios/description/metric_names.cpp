#include "results/summary/summary.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

MetricList metrics_without_values(const MetricSections& sections) {
  RunSummary run;
  if (sections.energy) run.energy.emplace();
  if (sections.ideal_trajectory) run.ideal_trajectory.emplace();
  if (sections.fidelity) run.fidelity.emplace();
  if (sections.torque) run.torque.emplace();
  if (sections.perception) run.perception.emplace();
  if (sections.places > 0) run.targets.emplace();
  for (std::size_t place = 0; place < sections.places; ++place) run.targets->emplace_back().place = place;
  MetricList metrics = metric_list(run);
  for (Metric& metric : metrics) metric.value = {};
  return metrics;
}

std::vector<std::string> metric_names(const MetricSections& sections) {
  std::vector<std::string> names;
  for (Metric& metric : metrics_without_values(sections)) names.push_back(std::move(metric.name));
  return names;
}

}  // namespace hapbench
