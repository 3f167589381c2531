#pragma once

#include <map>
#include <string>
#include <vector>

#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {

/// Returns the error estimates of metrics of one scene, by name: the largest change of each value in `metrics` if the
/// time step is halved, if the point spacing is halved, and if the depth is evaluated at every step. Omits a metric
/// that a refined run lacks. Makes one to three runs with up to `threads` threads.
std::map<std::string, double> metric_errors(const ScenarioText& scene, const std::vector<std::string>& overrides,
                                            const std::map<std::string, double>& metrics, unsigned threads);

}  // namespace hapbench
