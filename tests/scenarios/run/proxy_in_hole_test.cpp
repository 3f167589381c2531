#include <gtest/gtest.h>

#include "algorithms/depth/shortest_distance.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/environment_points.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/contact/shell_query.hpp"

/// The drill turned in the hole under 2 N: what the proxy promises, over a whole run.
namespace hapbench {
namespace {

LoadedScenario rotate_in_hole(const char* algorithm) {
  const std::vector<std::string> overrides = {std::string("rendering.algorithm=") + algorithm};
  return load_scenario(find_scenario("rotate_in_hole_proxy"), overrides);
}

/// Where the proxy is follows from the spring: p + f_spring / K. Looks for points in it by brute force.
class PointsInProxy final : public Observer {
 public:
  PointsInProxy(const PointShell& shell, const ToolShape& tool, double K)
      : query_(shell, tool), contacts_(query_.capacity()), tool_(&tool), K_(K) {}

  void on_step(const StepRecord& record) noexcept override {
    const ToolPose proxy{record.tool.pose.position + record.force.spring / K_, record.tool.pose.axis};
    query_.contacts_at(proxy, contacts_);
    tool_->shortest_depths(proxy, contacts_);
    for (std::size_t i = 0; i < contacts_.size(); ++i) deepest = std::max(deepest, contacts_.depth[i]);
    stiffest = std::max(stiffest, lambda_max(record.force.S));
    force_step = std::max(force_step, (record.force.rendered - last_).norm());
    last_ = record.force.rendered;
  }

  double deepest = 0.0, stiffest = 0.0, force_step = 0.0;

 private:
  ShellQuery query_;
  ContactBuffer contacts_;
  const ToolShape* tool_;
  double K_;
  Vec3 last_ = Vec3::Zero();
};

TEST(ProxyInHole, NeitherEntersTheShellNorGetsStifferThanOneSpring) {
  Scenario scenario = rotate_in_hole("proxy").scenario;
  scenario.time.steps = 10'240;  // one period of the tilt
  const auto shell = make_shell(scenario);
  SimulationParts parts = assemble(scenario, shell, {});
  PointsInProxy points(*shell, *parts.tool, scenario.rendering.stiffness);
  Simulation simulation(simulation_config(scenario), std::move(parts), {&points});
  EXPECT_EQ(simulation.run().outcome, Outcome::completes);
  EXPECT_LE(points.deepest, 1e-6);
  EXPECT_LE(points.stiffest, 1.0 + 1e-12);
}

TEST(ProxyInHole, IsFiveTimesNearerToTheIdealTrajectoryThanShapingAndVibratesLess) {
  const auto summary = [](const char* algorithm) {
    return run_scenario(rotate_in_hole(algorithm), std::nullopt, false).summary;
  };
  const RunSummary proxy = summary("proxy"), shaped = summary("shaped_stiffness");
  EXPECT_LE(proxy.ideal_trajectory->firm.height_rms, 0.00015);
  EXPECT_GE(shaped.ideal_trajectory->firm.height_rms, 5.0 * proxy.ideal_trajectory->firm.height_rms);
  EXPECT_LE(*proxy.metrics.vibration_power, *shaped.metrics.vibration_power);
  EXPECT_LE(proxy.metrics.velocity_total_variation, shaped.metrics.velocity_total_variation);
}

}  // namespace
}  // namespace hapbench
