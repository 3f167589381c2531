#include "results/summary.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {
namespace {

/// The thesis's tasks have two.
constexpr std::size_t kPlacesWithBounds = 2;

}  // namespace

std::vector<std::string> metric_names() {
  RunSummary all;
  all.energy.emplace();
  all.ideal_trajectory.emplace();
  auto& places = all.targets.emplace();
  for (std::size_t place = 0; place < kPlacesWithBounds; ++place) places.emplace_back().place = place;
  std::vector<std::string> names;
  const auto metrics = boundable_metrics(all);
  for (const auto& metric : metrics.items()) {
    if (metric.key() != "final_position_m") names.push_back(metric.key());
  }
  return names;
}

}  // namespace hapbench
