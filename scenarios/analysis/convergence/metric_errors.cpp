#include "scenarios/analysis/convergence/metric_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/run/scene_checks.hpp"

namespace hapbench {

/// Returns the cases of the refined runs of a scene, one list for each refined run. If the scene has no surface points,
/// leaves out the refinements that need surface points.
static std::vector<Cases> refined_cases(const ScenarioText& scene, const std::vector<std::string>& overrides,
                                        Refinement refinement) {
  const LoadedScenario scenario = load_scenario(scene, overrides);
  const auto distance = point_distance(scenario);
  const Cases once({scene}, overrides, std::vector<Axis>{});
  std::vector<Cases> finer;
  if (refinement == Refinement::resolution) {
    finer.push_back(finer_cases(level_sweep(scenario, kStepPath, 2, 2.0), once));
    if (distance) finer.push_back(finer_cases(level_sweep(scenario, distance->path, 2, 2.0), once));
  } else if (distance) {
    finer.emplace_back(std::vector{scene}, overrides, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  return finer;
}

MetricValues metric_changes(const ScenarioText& scene, const std::vector<std::string>& overrides,
                            const MetricValues& metrics, Refinement refinement, unsigned threads, std::size_t& runs) {
  const std::vector<Result> refined = run_all(refined_cases(scene, overrides, refinement), {threads, ""});
  runs += refined.size();
  MetricValues changes;
  for (const auto& [name, value] : metrics) {
    double& largest = changes[name] = 0.0;
    for (const Result& run : refined) {
      const double moved = number_of(run.metrics, name).value_or(std::numeric_limits<double>::infinity());
      largest = std::max(largest, std::abs(moved - value));
    }
  }
  return changes;
}

MetricErrors metric_errors(const ScenarioText& scene, const std::vector<std::string>& overrides,
                           const MetricValues& metrics, unsigned threads) {
  MetricErrors found;
  const auto changes = [&](Refinement refinement) {
    return metric_changes(scene, overrides, metrics, refinement, threads, found.runs);
  };
  found.errors = changes(Refinement::resolution);
  const bool has_depth =
      std::ranges::any_of(metrics, [](const auto& entry) { return depends_on_sampled_depth(entry.first); });
  if (has_depth)
    for (const auto& [name, change] : changes(Refinement::depth))
      found.errors[name] = std::max(found.errors[name], change);
  std::erase_if(found.errors, [](const auto& entry) { return !std::isfinite(entry.second); });
  return found;
}

}  // namespace hapbench
