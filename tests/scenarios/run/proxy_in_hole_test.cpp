#include <gtest/gtest.h>

#include "algorithms/proxy/proxy_rendering.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/contact/contact_source.hpp"
#include "tests/support/scale.hpp"

/// The guarantees of the proxy, over whole runs.
namespace hapbench::proxy_in_hole_test {
namespace {

LoadedScenario with_algorithm(const char* scenario, const char* algorithm) {
  const std::vector<std::string> overrides = {std::string("rendering.algorithm=") + algorithm};
  return load_scenario(find_scenario(scenario), overrides);
}

/// The rounding of a proxy's place, and what a move of a millimetre at most may violate (kViolationTolerance).
constexpr double kOutside = 1e-9;
/// Deeper than this, the drill's proxy leaves slowly [m]: a step at kRecoverySpeed.
constexpr double kRecovery = 1e-5;

/// Looks for points in the proxy by brute force. Its place follows from the spring: p + f_spring / K.
class PointsInProxy final : public Observer {
 public:
  PointsInProxy(const PointShell& shell, const SimulationParts& parts, double K)
      : query_(shell, *parts.tool),
        contacts_(query_.capacity()),
        tool_(parts.tool.get()),
        algorithm_(parts.algorithm.get()),
        K_(K) {}

  void on_step(const StepRecord& record) noexcept override {
    const ToolPose proxy{record.tool.pose.position + record.force.spring / K_, record.tool.pose.axis};
    query_.contacts_at(proxy, contacts_);
    tool_->shortest_depths(proxy, contacts_);
    const double depth = contacts_.largest_depth();
    if (cleared) deepest = std::max(deepest, depth);
    steps_until_clear += !cleared;
    if (last_depth_ > kRecovery) fastest = std::max(fastest, (proxy.position - last_).norm() / algorithm_dt);
    last_depth_ = depth;
    cleared = cleared || depth <= kOutside;
    last_ = proxy.position;
    stiffest = std::max(stiffest, lambda_max(record.force.S));
    largest_force = std::max(largest_force, record.force.spring.norm());
    const std::uint64_t passes = algorithm_->work().search.queries;
    most_passes = std::max(most_passes, passes - passes_);
    passes_ = passes;
  }

  double algorithm_dt = 1.0;
  bool cleared = false;  ///< no point was inside once
  std::uint64_t steps_until_clear = 0, most_passes = 0;
  double deepest = 0.0;  ///< since then [m]
  double fastest = 0.0;  ///< proxy that leaves slowly [m/s]
  double stiffest = 0.0, largest_force = 0.0;

 private:
  ShellQuery query_;
  ContactBuffer contacts_;
  const ToolShape* tool_;
  const ForceAlgorithm* algorithm_;
  double K_;
  std::uint64_t passes_ = 0;
  Vec3 last_ = Vec3::Zero();
  double last_depth_ = 0.0;
};

PointsInProxy watch(const char* name, std::int64_t steps) {
  Scenario scenario = with_algorithm(name, "proxy").scenario;
  scenario.time.steps = std::min(scenario.time.steps, steps);
  const auto shell = make_shell(scenario);
  SimulationParts parts = assemble(scenario, NamedFiles(scenario), shell, {});
  PointsInProxy points(*shell, parts, scenario.rendering.stiffness);
  points.algorithm_dt = scenario.time.step;
  Simulation simulation(simulation_config(scenario), std::move(parts), {&points});
  simulation.run();
  return points;
}

struct Run {
  const char* scenario;
  std::int64_t steps;
  double allowed = kOutside;  ///< [m]
};
/// In a corner, patches may leave no room where the points do; they are at most this deep then, and share it with the
/// points: a tenth of the spacing.
constexpr double kShared = 1e-5;
class ProxyOverAWholeRun : public testing::TestWithParam<Run> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ProxyOverAWholeRun,
                         testing::Values(Run{"rotate_in_hole_proxy", 10'240, 1e-6},  // one period of the tilt
                                         Run{"rotational_peg_in_hole_shaped_stiffness", 5'120, kShared},
                                         Run{"vertical_peg_in_hole_shaped_stiffness", 5'120},
                                         Run{"round_the_wall", 5'120}, Run{"recorded_stroke", 5'120},
                                         Run{"drag_molar", 4'096}),
                         [](const auto& run) { return std::string(run.param.scenario); });

TEST_P(ProxyOverAWholeRun, NeitherEntersTheShellNorGetsStifferThanOneSpringNorTakesManyPasses) {
  const PointsInProxy points =
      watch(GetParam().scenario, GetParam().steps / static_cast<std::int64_t>(test::sanitized(16)));
  EXPECT_TRUE(points.cleared);
  // The hands of the pegs start up to 22 um deep, and leave by 10 um a step.
  EXPECT_LE(points.steps_until_clear, 10u);
  EXPECT_LE(points.deepest, GetParam().allowed);
  EXPECT_LE(points.stiffest, 1.0 + 1e-12);
  EXPECT_LE(points.most_passes, 10u);
}

/// 0.4 mm deep in both walls of a hole as wide as the peg, which tilted fits nowhere.
TEST(ProxyInATightHole, LeavesSlowly) {
  const PointsInProxy points = watch("peg_in_hole_2d_shaped_stiffness", 2'000);
  // A move is only nearly proportional to the depths.
  EXPECT_LE(points.fastest, 1.1 * 0.02);
  EXPECT_LE(points.largest_force, 2.0);
}

TEST(ProxyInHole, IsFiveTimesNearerToTheIdealTrajectoryThanShapingAndVibratesLess) {
  const auto summary = [](const char* algorithm) {
    return run_scenario(with_algorithm("rotate_in_hole_proxy", algorithm), std::nullopt, false);
  };
  const Result proxy = summary("proxy"), shaped = summary("shaped_stiffness");
  const char* height_rms = "ideal_trajectory.firm.height_error_rms_m";
  EXPECT_LE(number_of(proxy.metrics, height_rms).value(), 0.00015);
  EXPECT_GE(number_of(shaped.metrics, height_rms).value(), 5.0 * number_of(proxy.metrics, height_rms).value());
  for (const char* name : {"vibration_power_above_30Hz_m2_per_s2", "velocity_total_variation_m_per_s"})
    EXPECT_LE(number_of(proxy.metrics, name).value(), number_of(shaped.metrics, name).value()) << name;
}

}  // namespace
}  // namespace hapbench::proxy_in_hole_test
