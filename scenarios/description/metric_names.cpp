#include "results/summary/summary.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

std::vector<std::string> metric_names(const MetricSections& sections) {
  RunSummary run;
  if (sections.energy) run.energy.emplace();
  if (sections.ideal_trajectory) run.ideal_trajectory.emplace();
  if (sections.places > 0) run.targets.emplace();
  for (std::size_t place = 0; place < sections.places; ++place) run.targets->emplace_back().place = place;
  std::vector<std::string> names;
  const auto metrics = boundable_metrics(run);
  for (const auto& metric : metrics.items()) {
    if (metric.key() != "final_position_m") names.push_back(metric.key());
  }
  return names;
}

}  // namespace hapbench
