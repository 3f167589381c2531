#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// Values of metrics by name, each in the unit of its metric.
using MetricValues = std::map<std::string, double, std::less<>>;

/// Error estimates of the metrics of one run.
struct MetricErrors {
  MetricValues errors = {};  ///< error estimates of the metrics; metrics that a refined run lacks are missing
  std::size_t runs = 0;      ///< number of refined runs, one to three
};

/// Returns the error estimates of metrics of one scene: the largest change of each value in `metrics` if the time step
/// is halved, if the point spacing is halved, and if the depth is evaluated at every step. Uses up to `threads`
/// threads.
MetricErrors metric_errors(const ScenarioText& scene, const std::vector<std::string>& overrides,
                           const MetricValues& metrics, unsigned threads);

}  // namespace hapbench
