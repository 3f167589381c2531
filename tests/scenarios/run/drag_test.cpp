#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "results/observe/metrics.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_facts.hpp"

/// The hand that drags the tool over a surface, in the loop.
namespace hapbench::drag_test {
namespace {

Json scene() {
  return Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 5000},
    "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0001},
    "initial": {"position_m": [-0.002, 0, 0.0002]},
    "hand": {"type": "drag", "force_N": 1, "direction": [1, 0, 0], "speed_m_per_s": 0.001,
             "stiffness_N_per_m": 300, "damping_N_s_per_m": 6, "normal_damping_N_s_per_m": 50},
    "rendering": {"algorithm": "shaped_stiffness", "reduction": null, "depth_model": "normal_projection", "stiffness_N_per_m": 20000, "damping_ratio": 0.7,
                  "mass_kg": 0.1, "friction": {"mu_s_N_s_per_m": 5, "mu_f_s_per_m": 10}}
  })");
}

/// Keeps the last row.
struct LastRow final : Observer {
  void on_step(const StepRecord& row) noexcept override {
    tool = row.tool;
    rendered = row.force.rendered;
    time = row.time;
  }
  ToolState tool;
  Vec3 rendered = Vec3::Zero();
  double time = 0.0;
};

LastRow run(const Scenario& scenario) {
  LastRow last;
  Simulation simulation(simulation_config(scenario), assemble(scenario), {&last});
  EXPECT_EQ(simulation.run().outcome, Outcome::completes);
  return last;
}

TEST(Drag, PressesWithItsForceAndLagsAsItsSpringSays) {
  for (const char* algorithm : {"shaped_stiffness", "mean", "proxy"}) {
    Json json = scene();
    json["rendering"]["algorithm"] = algorithm;
    const LastRow last = run(read_scenario(json, "").scenario);
    // On a plane every contact has one gradient, and with normal projection one depth, also at the rim of the tip, so
    // that all laws are one spring K and one damper B = 62.6 N s/m, whichever points come and go. Along the
    // normal, s^2 + (B + 50) / M s + K / M has the roots -221 and -905 /s: after 2.5 s nothing is left but rounding,
    // which is that of a depth of 0.05 mm times K.
    EXPECT_NEAR(last.rendered.z(), 1.0, 1e-10) << algorithm;
    // Within the surface friction (5 + 10 F) N s/m is what the spring has to overcome; the roots are -15 and -195 /s,
    // exp(-15.4 * 2.5) = 2e-17.
    const double moving_point = -0.002 + 0.001 * last.time;
    EXPECT_NEAR(moving_point - last.tool.pose.position.x(), (5.0 + 10.0) * 0.001 / 300.0, 1e-12) << algorithm;
    EXPECT_NEAR(last.tool.velocity.x(), 0.001, 1e-12) << algorithm;
    EXPECT_LT((last.tool.pose.axis - Vec3(0, 0, -1)).norm(), 1e-12) << algorithm;
  }
}

TEST(Drag, OrientationIsTheMotionsWithoutATilt) {
  Json json = scene();
  json["time"]["steps"] = 10;
  json["hand"]["tilt_rad"] = nullptr;
  json["motion"]["orientation"]["tilt_rad"] = 0.2;
  EXPECT_LT((run(read_scenario(json, "").scenario).tool.pose.axis - Vec3(-std::sin(0.2), 0, -std::cos(0.2))).norm(),
            1e-15);
}

TEST(Drag, OverAMeshKeepsContactAndAllocatesNothing) {
  Json json = scene();
  json["environment"] = {{"type", "mesh"}, {"file", "cube.obj"}, {"scale", 0.001}, {"spacing_m", 0.0002}};
  json["initial"]["position_m"] = {-0.002, 0, 0.0057};
  json["tool"] = {{"diameter_m", 0.001}, {"tip", "round"}};
  json["hand"]["tilt_rad"] = 0.3;
  const RunReport report = run_scenario(read_scenario(json, HAPBENCH_TEST_DATA), std::nullopt, false);
  EXPECT_EQ(report.summary.work.allocations, 0u);
  EXPECT_EQ(report.summary.result.outcome, Outcome::completes);
  // Lowered at 20 mm/s it is on the cube after a tenth of a second.
  EXPECT_GT(report.summary.metrics.steps_in_contact, 4500u);
}

std::string warnings_of(const RunReport& report) {
  std::string text;
  for (const std::string& warning : report.summary.warnings) text += warning + "\n";
  return text;
}

TEST(Drag, ThatFollowsGivesNoWarning) {
  EXPECT_EQ(warnings_of(run_scenario(read_scenario(scene(), ""), std::nullopt, false)), "");
}

TEST(Drag, TellsOfAToolThatStandsStill) {
  Json json = scene();
  // Friction takes over 100 N at 1 mm/s; the spring has 0.0075 m * 300 N/m at most.
  json["rendering"]["friction"] = {{"mu_s_N_s_per_m", 1e5}, {"mu_f_s_per_m", 0}};
  json["integrator"] = {{"type", "implicit_euler"}};
  json["tool"] = {{"diameter_m", 0.0005}};
  const RunReport report = run_scenario(read_scenario(json, ""), std::nullopt, false);
  EXPECT_EQ(report.summary.result.outcome, Outcome::not_dragged);
  EXPECT_NE(warnings_of(report).find("the dragged tool stood still since"), std::string::npos) << warnings_of(report);
}

TEST(Drag, WithoutAWayIsNotDraggedAndToldOfBeforeItRuns) {
  Json json = scene();
  json["hand"]["direction"] = {0, 0, 1};
  json["tool"] = {{"diameter_m", 0.0005}};
  Json to_and_fro = scene();  // both points are nearest to one place
  to_and_fro["hand"].erase("direction");
  to_and_fro["hand"]["path_m"] = {{-0.002, 0, 0.003}, {-0.002, 0, 0}};
  to_and_fro["tool"] = json["tool"];
  for (const auto& [scenario, remedy] :
       {std::pair(json, "hand.smoothing_m"), {to_and_fro, "let its points lie on it"}}) {
    const LoadedScenario loaded = read_scenario(scenario, "");
    const std::vector<std::string> before = scene_facts(loaded).warnings;
    ASSERT_EQ(before.size(), 1u) << remedy;
    EXPECT_NE(before[0].find(remedy), std::string::npos) << before[0];
    const RunReport report = run_scenario(loaded, std::nullopt, false);
    EXPECT_EQ(report.summary.result.outcome, Outcome::not_dragged);
    EXPECT_EQ(report.unmet.size(), 1u);
    EXPECT_NE(warnings_of(report).find(remedy), std::string::npos) << warnings_of(report);
  }
  EXPECT_TRUE(scene_facts(read_scenario(scene(), "")).warnings.empty());
}

TEST(Drag, TellsOfAToolThatLostTheSurface) {
  Json json = scene();
  json["hand"]["force_N"] = 50;
  json["rendering"]["stiffness_N_per_m"] = 100;
  json["tool"] = {{"diameter_m", 0.0005}};
  const RunReport report = run_scenario(read_scenario(json, ""), std::nullopt, false);
  EXPECT_EQ(report.summary.result.outcome, Outcome::lost_contact);
  EXPECT_NE(warnings_of(report).find("the dragged tool lost the surface at"), std::string::npos) << warnings_of(report);
  EXPECT_NE(warnings_of(report).find("below it: it went through"), std::string::npos) << warnings_of(report);
}

}  // namespace
}  // namespace hapbench::drag_test
