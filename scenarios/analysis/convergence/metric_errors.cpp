#include "scenarios/analysis/convergence/metric_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/run/scene_checks.hpp"

namespace hapbench {

MetricErrors metric_errors(const ScenarioText& scene, const std::vector<std::string>& overrides,
                           const MetricValues& metrics, unsigned threads) {
  const LoadedScenario scenario = load_scenario(scene, overrides);
  const Cases once({scene}, overrides, std::vector<Axis>{});
  std::vector<Cases> finer = {finer_cases(level_sweep(scenario, kStepPath, 2, 2.0), once)};
  if (const auto distance = point_distance(scenario)) {
    finer.push_back(finer_cases(level_sweep(scenario, distance->path, 2, 2.0), once));
    finer.emplace_back(std::vector{scene}, overrides, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  const std::vector<Result> runs = run_all(finer, {threads, ""});
  MetricErrors found{{}, runs.size()};
  for (const auto& [name, value] : metrics) {
    double largest = 0.0;
    for (const Result& run : runs) {
      const double moved = number_of(run.metrics, name).value_or(std::numeric_limits<double>::infinity());
      largest = std::max(largest, std::abs(moved - value));
    }
    if (std::isfinite(largest)) found.errors[name] = largest;
  }
  return found;
}

}  // namespace hapbench
