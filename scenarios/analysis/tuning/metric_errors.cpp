#include "scenarios/analysis/tuning/metric_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_distances.hpp"

namespace hapbench {

TuneMetrics known_errors(const TuneQuestion& question, const std::vector<std::string>& overrides,
                         const TuneMetrics& metrics, std::size_t& runs) {
  const ScenarioText& scene = question.scenario;
  const LoadedScenario scenario = load_scenario(scene, overrides);
  const Cases once({scene}, overrides, std::vector<Axis>{});
  std::vector<Cases> finer = {finer_cases(level_sweep(scenario, kStepPath, 2, 2.0), once)};
  if (const auto distance = point_distance(scenario)) {
    finer.push_back(finer_cases(level_sweep(scenario, distance->path, 2, 2.0), once));
    finer.emplace_back(std::vector{scene}, overrides, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  runs += finer.size();
  const std::vector<Result> results = run_all(finer, {question.threads, ""});
  // The error of a metric is its largest change; a metric that a run lacks has none.
  TuneMetrics error;
  for (const auto& [name, value] : metrics) {
    double largest = 0.0;
    for (const Result& run : results) {
      const double moved = number_of(run.metrics, name).value_or(std::numeric_limits<double>::infinity());
      largest = std::max(largest, std::abs(moved - value));
    }
    if (std::isfinite(largest)) error[name] = largest;
  }
  return error;
}

}  // namespace hapbench
