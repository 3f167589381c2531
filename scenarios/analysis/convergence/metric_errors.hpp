#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
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

/// Refinements of a run that estimate the errors of its metrics.
enum class Refinement {
  resolution,  ///< two runs: half the time step, and half the point spacing
  depth  ///< one run with the depth evaluated at every step: ten times as expensive as the run of the scene itself
};

/// Returns true for the two metrics of the depth of the tool inside the environment. Evaluating the depth at every step
/// can change only these metrics.
inline bool depends_on_sampled_depth(std::string_view metric) {
  return metric == "inside_max_m" || metric == "inside_settled_m";
}

/// Returns, for each value in `metrics`, the largest change over the refined runs of `refinement`; infinite for a
/// metric that a refined run lacks. Uses up to `threads` threads. Adds the number of refined runs to `runs`. Without
/// surface points, Refinement::depth makes no run and all its changes are 0.
MetricValues metric_changes(const ScenarioText& scene, const std::vector<std::string>& overrides,
                            const MetricValues& metrics, Refinement refinement, unsigned threads, std::size_t& runs);

/// Returns the error estimates of metrics of one scene: the largest change of each value in `metrics` if the time step
/// is halved, if the point spacing is halved, and, if `metrics` has a depth metric (depends_on_sampled_depth), if the
/// depth is evaluated at every step. Uses up to `threads` threads.
MetricErrors metric_errors(const ScenarioText& scene, const std::vector<std::string>& overrides,
                           const MetricValues& metrics, unsigned threads);

}  // namespace hapbench
