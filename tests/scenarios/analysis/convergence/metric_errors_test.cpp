#include "scenarios/analysis/convergence/metric_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench::metric_errors_test {
namespace {

Result run(const char* scene, std::vector<std::string> overrides) {
  return run_scenario(checked(load_scenario(find_scenario(scene), overrides)), std::nullopt, false);
}

/// Checks that evaluating the depth at every step changes only the two metrics that depend on the sampled depth.
TEST(MetricErrors, TheDepthOfEveryStepChangesNoOtherMetric) {
  for (const char* scene : {"drag_molar", "tap_wall", "device_in_hole"}) {
    const Result sampled = run(scene, {"time.duration_s=0.3", "expect={}"}),
                 all = run(scene, {"time.duration_s=0.3", "expect={}", "record.inside=true"});
    ASSERT_EQ(sampled.metrics.size(), all.metrics.size());
    for (std::size_t i = 0; i < all.metrics.size(); ++i) {
      if (depends_on_sampled_depth(all.metrics[i].name)) continue;
      EXPECT_EQ(sampled.metrics[i].value, all.metrics[i].value) << scene << ": " << all.metrics[i].name;
    }
    // The change is within the tolerance that the search for the deepest point states.
    const Metric* depth = find_metric(sampled.metrics, "inside_max_m");
    ASSERT_NE(depth, nullptr);
    EXPECT_LE(std::abs(*number_of(all.metrics, "inside_max_m") - *number_of(sampled.metrics, "inside_max_m")),
              *depth->tolerance())
        << scene;
  }
}

TEST(MetricErrors, MakesNoRunThatCannotChangeAMetric) {
  const ScenarioText scene = read_scenario_text(find_scenario("tap_wall"));
  const MetricValues force = {{"force_max_N", 1.0}};
  MetricValues both = force;
  both["inside_max_m"] = 1e-4;
  const std::vector<std::string> brief = {"time.duration_s=0.1"};
  const MetricErrors one = metric_errors(scene, brief, force, 1), two = metric_errors(scene, brief, both, 1);
  EXPECT_EQ(one.runs, 2u);
  EXPECT_EQ(two.runs, 3u);
  EXPECT_EQ(one.errors.at("force_max_N"), two.errors.at("force_max_N"));
}

}  // namespace
}  // namespace hapbench::metric_errors_test
