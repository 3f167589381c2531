#include "scenarios/run/outcome.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/observe/metrics.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "tests/scenarios/support/bundled.hpp"

/// The outcomes of runs that miss or lose their object, whether they were expected, and the warnings about them.
namespace hapbench::outcome_test {
namespace {

/// A tool of 1 mm above a plane of 10 mm, which a hand pushes.
Json above_plane() {
  return Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 100},
    "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0005},
    "tool": {"diameter_m": 0.001}, "initial": {"position_m": [0, 0, 0.003]},
    "hand": {"type": "force", "z_N": -1}, "rendering": {"mass_kg": 0.1}
  })");
}

/// The run of that scene with a patch.
Result run_of(const char* patch) {
  Json json = above_plane();
  json.merge_patch(Json::parse(patch));
  return run_scenario(read_scenario(json, HAPBENCH_TEST_DATA), std::nullopt, false);
}

TEST(Outcome, LostContactWhenTheToolEndedFarAway) {
  const char* const pushed = R"({"initial": {"position_m": [0, 0, 0]}, "time": {"steps": 500},
                                 "hand": {"x_N": 8, "z_N": -0.5}})";
  const Result run = run_of(pushed);
  EXPECT_EQ(run.end.outcome, Outcome::lost_contact);
  ASSERT_EQ(run.warnings.size(), 1u);
  EXPECT_TRUE(run.warnings[0].text.ends_with(
      " away from the environment (10 x 10 x 0 mm: x -5 ... 5, y -5 ... 5, z 0 ... 0 mm); a hand of constant force "
      "goes on pushing where there is no surface"))
      << run.warnings[0].text;
}

TEST(Outcome, AScriptMayLeadTheToolAway) {
  const char* const led = R"({"initial": null, "hand": null, "motion": {"position": {"type": "prescribed",
      "x_m": 0, "y_m": 0, "z_m": {"type": "waypoints", "points": [[0, 0], [0.04, 1]]}}}})";
  EXPECT_EQ(run_of(led).end.outcome, Outcome::completes);
}

/// The tip centre is in the environment's box all the time, 1 mm from the wall of a hole of 2 mm.
TEST(Outcome, NoContactIsMeasuredToTheSurface) {
  const char* const in_hole =
      R"({"hand": null, "initial": {"position_m": [0, 0, -0.001]}, "tool": {"diameter_m": 0.0006},
      "environment": {"type": "block_with_hole", "size_m": [0.006, 0.005, 0.004], "hole_diameter_m": 0.002,
                      "hole_depth_m": 0.003, "grid_m": 0.0001, "spacing_m": null}})";
  const Result run = run_of(in_hole);
  EXPECT_EQ(run.end.outcome, Outcome::no_contact);
  ASSERT_EQ(run.warnings.size(), 1u);
  const std::string begin = "never in contact: the tool came as close as ";
  ASSERT_TRUE(run.warnings[0].text.starts_with(begin)) << run.warnings[0].text;
  EXPECT_NEAR(std::stod(run.warnings[0].text.substr(begin.size())), 1.0 - 0.3, 0.01) << run.warnings[0].text;
  EXPECT_TRUE(run.warnings[0].text.ends_with("; nothing pushes the tool: is hand missing?")) << run.warnings[0].text;
}

TEST(Outcome, NoContactTellsTheLikelyCause) {
  for (const auto& [patch, cause] : {
           std::pair{R"({"hand": {"z_N": 1}})", "; is initial.position_m right?"},
           {R"({"hand": {"type": "impedance", "z_N": null, "stiffness_N_per_m": 300, "damping_N_s_per_m": 6,
                        "target": {"x_m": 0, "y_m": 0, "z_m": 0.003}}})",
            "; does hand.target lead to the surface?"},
           {R"({"hand": {"z_N": 1}, "environment": {"type": "mesh", "file": "cube.obj", "scale": 1e-6, "size_m": null,
                                                    "spacing_m": null}})",
            "; is environment.scale right?"},
           {R"({"hand": null, "initial": null,
               "motion": {"position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": 0.003}}})",
            "; is motion.position right?"},
           // 1.5 mm above the plane and 1 mm/s down, for 0.05 s.
           {R"({"hand": null, "initial": null,
               "motion": {"position": {"type": "prescribed", "x_m": 0, "y_m": 0,
                                       "z_m": {"type": "waypoints", "points": [[0, 0.0015], [1, 0.0005]]}}}})",
            "; it came nearer to the end and would touch in 1.5 s: is time.steps too small?"},
           // A tenth as fast, even a run that is a hundred times as long would not do.
           {R"({"hand": null, "initial": null,
               "motion": {"position": {"type": "prescribed", "x_m": 0, "y_m": 0,
                                       "z_m": {"type": "waypoints", "points": [[0, 0.0015], [1, 0.0014]]}}}})",
            "; is motion.position right?"},
       }) {
    const Result run = run_of(patch);
    EXPECT_EQ(run.end.outcome, Outcome::no_contact) << cause;
    ASSERT_FALSE(run.warnings.empty()) << cause;
    EXPECT_TRUE(run.warnings[0].text.ends_with(cause)) << run.warnings[0].text;
  }
}

/// What is said of those that are not met is in tests/data/golden/ends.txt.
TEST(Expectation, IncludesItsBoundsAndMayBoundEveryMetric) {
  Result run;
  run.metrics = all_metrics();
  ASSERT_EQ(run.metrics.front().name, "force_max_N");
  run.metrics.front().value = 2.0;
  const auto unmet = [&run](const std::string& name, const MetricBound& bound) {
    ExpectFields expect;
    expect.metrics[name] = bound;
    return unmet_expectations(expect, run).size();
  };
  for (const MetricBound& bound : {MetricBound{2.0, 2.0}, MetricBound{{}, 2.0}, MetricBound{2.0, {}}, MetricBound{}})
    EXPECT_EQ(unmet("force_max_N", bound), 0u);
  EXPECT_GE(all_metrics().size(), 12u);
  for (const Metric& metric : all_metrics()) EXPECT_EQ(unmet(metric.name, {1e15, {}}), 1u) << metric.name;
}

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

TEST(Drag, PressesWithItsForceAndLagsAsItsSpringSays) {
  for (const char* algorithm : {"shaped_stiffness", "mean", "proxy"}) {
    Json json = scene();
    json["rendering"]["algorithm"] = algorithm;
    const StepRecord last = test::rows_of(read_scenario(json, "").scenario).back();
    // On a plane every contact has one gradient, and with normal projection one depth, also at the rim of the tip, so
    // that all laws are one spring K and one damper B = 62.6 N s/m, whichever points come and go. Along the
    // normal, s^2 + (B + 50) / M s + K / M has the roots -221 and -905 /s: after 2.5 s nothing is left but rounding,
    // which is that of a depth of 0.05 mm times K.
    EXPECT_NEAR(last.force.rendered.z(), 1.0, 1e-10) << algorithm;
    // Within the surface friction (5 + 10 F) N s/m is what the spring has to overcome; the roots are -15 and -195 /s,
    // exp(-15.4 * 2.5) = 2e-17.
    const double moving_point = -0.002 + 0.001 * last.time;
    EXPECT_NEAR(moving_point - last.tool.pose.position.x(), (5.0 + 10.0) * 0.001 / 300.0, 1e-12) << algorithm;
    EXPECT_NEAR(last.tool.velocity.x(), 0.001, 1e-12) << algorithm;
    EXPECT_LT((last.tool.pose.axis - Vec3(0, 0, -1)).norm(), 1e-12) << algorithm;
  }
}

std::string warnings_of(const Result& report) {
  std::string text;
  for (const Warning& warning : report.warnings) text += warning.told() + "\n";
  return text;
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
    const std::vector<Warning> before = scene_facts(loaded).warnings;
    ASSERT_EQ(before.size(), 1u) << remedy;
    EXPECT_NE(before[0].text.find(remedy), std::string::npos) << before[0].text;
    const Result report = run_scenario(loaded, std::nullopt, false);
    EXPECT_EQ(report.end.outcome, Outcome::not_dragged);
    EXPECT_EQ(report.unmet.size(), 1u);
    EXPECT_NE(warnings_of(report).find(remedy), std::string::npos) << warnings_of(report);
  }
  EXPECT_TRUE(scene_facts(read_scenario(scene(), "")).warnings.empty());
}

/// A drill turned into the wall of its hole about its resting tip: the axis of its shank is in the wall in the end,
/// while the tip centre and the core behind it have always been in the hole.
TEST(Outcome, OfAShankThatIsInside) {
  const LoadedScenario loaded = load_scenario(find_scenario("pure_rotation"), {});
  const Result report = run_scenario(loaded, std::nullopt, false);
  EXPECT_EQ(report.end.outcome, Outcome::went_through);
  EXPECT_TRUE(report.unmet.empty());
  // By 0.2 rad the shank only presses on the rim.
  const std::vector<std::string> half = {"motion.orientation.tilt_rad=0.2", "expect={}"};
  EXPECT_EQ(run_scenario(load_scenario(find_scenario("pure_rotation"), half), std::nullopt, false).end.outcome,
            Outcome::completes);
  EXPECT_NE(warnings_of(report).find("a part of it was 0.86"), std::string::npos) << warnings_of(report);
}

}  // namespace
}  // namespace hapbench::outcome_test
