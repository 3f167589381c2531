#include "results/summary.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  const auto summary = summary_json(RunSummary{});
  for (const auto& metric : summary["metrics"].items()) {
    if (metric.key() != "final_position_m") names.push_back(metric.key());
  }
  return names;
}

}  // namespace hapbench
