#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "results/observe/metrics.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/tools.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/bundled.hpp"

namespace hapbench::outcome_test {
namespace {

// Tests the outcomes of runs whose tool never touches its environment or loses contact with it, whether these outcomes
// were expected, and the warnings of the runs.

/// Returns the scenario of a tool of 1 mm that a hand pushes towards a plane of 10 mm from 3 mm above it.
Json above_plane() {
  return Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 100},
    "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0005},
    "tool": {"diameter_m": 0.001}, "initial": {"position_m": [0, 0, 0.003]},
    "hand": {"type": "force", "z_N": -1}, "rendering": {"mass_kg": 0.1}
  })");
}

/// Returns the result of the scenario above_plane(), changed by a patch.
Result run_of(const char* patch) {
  Json json = above_plane();
  json.merge_patch(Json::parse(patch));
  return run_scenario(checked(read_scenario(json, HAPBENCH_TEST_DATA)), std::nullopt, false);
}

TEST(Outcome, LostContactWhenTheToolEndedFarAway) {
  const char* const pushed = R"({"initial": {"position_m": [0, 0, 0]}, "time": {"steps": 500},
                                 "hand": {"x_N": 8, "z_N": -0.5}})";
  const Result run = run_of(pushed);
  EXPECT_EQ(run.end.outcome, Outcome::lost_contact);
  ASSERT_EQ(run.warnings.size(), 1u);
  EXPECT_TRUE(run.warnings[0].text.ends_with(
      " away from the environment (10 x 10 x 0 mm: x -5 ... 5, y -5 ... 5, z 0 ... 0 mm); the hand keeps "
      "pushing with a constant force where there is no surface"))
      << run.warnings[0].text;
}

/// Checks a loop without damping, which throws the tool up against the push of the hand.
TEST(Outcome, LostContactNamesAForceThatThrewTheTool) {
  const Result run = run_of(R"({"time": {"step_s": 0.001, "steps": 2000}, "initial": {"position_m": [0, 0, 0.0001]},
      "environment": {"size_m": 0.02}, "tool": {"diameter_m": 0.004, "length_m": 0.03, "tip": "flat"},
      "hand": {"z_N": -0.05}, "device": {"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0},
      "rendering": {"stiffness_N_per_m": 100000, "damping_ratio": 0, "mass_kg": null,
                    "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}})");
  EXPECT_EQ(run.end.outcome, Outcome::lost_contact);
  ASSERT_FALSE(run.warnings.empty());
  EXPECT_NE(run.warnings[0].text.find("the force threw the tool against the hand's push"), std::string::npos)
      << run.warnings[0].text;
}

/// Checks the law `proxy` with a round tip between the points of the surface: no point collides, but the patches around
/// the points hold the tool.
TEST(Outcome, APatchBetweenThePointsIsAContact) {
  const Result run = run_of(R"({"time": {"step_s": 0.001, "steps": 2000}, "initial": {"position_m": [0, 0, 0.0031]},
      "environment": {"size_m": 0.02, "spacing_m": 0.0003}, "tool": {"diameter_m": 0.006, "length_m": 0.03,
      "tip": "round"}, "hand": {"z_N": -0.3}, "rendering": {"algorithm": "proxy", "stiffness_N_per_m": 126000,
      "damping_ratio": 0.3, "mass_kg": 0.08, "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}})");
  EXPECT_EQ(run.end.outcome, Outcome::completes);
}

TEST(Outcome, AScriptMayLeadTheToolAway) {
  const char* const led = R"({"initial": null, "hand": null, "motion": {"position": {"type": "prescribed",
      "x_m": 0, "y_m": 0, "z_m": {"type": "waypoints", "points": [[0, 0], [0.04, 1]]}}}})";
  EXPECT_EQ(run_of(led).end.outcome, Outcome::completes);
}

/// Checks that the distance in the warning is the tool's distance to the surface, not to the bounding box of the
/// environment. The tip centre is always inside this box, 1 mm from the wall of a hole of 2 mm diameter.
TEST(Outcome, NoContactIsMeasuredToTheSurface) {
  const char* const in_hole =
      R"({"hand": null, "initial": {"position_m": [0, 0, -0.001]}, "tool": {"diameter_m": 0.0006},
      "environment": {"type": "block_with_hole", "size_m": [0.006, 0.005, 0.004], "hole_diameter_m": 0.002,
                      "hole_depth_m": 0.003, "grid_m": 0.0001, "spacing_m": null}})";
  const Result run = run_of(in_hole);
  EXPECT_EQ(run.end.outcome, Outcome::no_contact);
  ASSERT_EQ(run.warnings.size(), 1u);
  const std::string begin = "the tool never touched the environment: its smallest distance to the surface was ";
  ASSERT_TRUE(run.warnings[0].text.starts_with(begin)) << run.warnings[0].text;
  EXPECT_NEAR(std::stod(run.warnings[0].text.substr(begin.size())), 1.0 - 0.3, 0.01) << run.warnings[0].text;
  EXPECT_TRUE(run.warnings[0].text.ends_with("; nothing pushes the tool: is hand missing?")) << run.warnings[0].text;
}

TEST(Outcome, NoContactNamesTheLikelyCause) {
  for (const auto& [patch, cause] : {
           std::pair{R"({"hand": {"z_N": 1}})", "; are initial.position_m and the hand's direction right?"},
           {R"({"hand": {"type": "impedance", "z_N": null, "stiffness_N_per_m": 300, "damping_N_s_per_m": 6,
                        "target": {"x_m": 0, "y_m": 0, "z_m": 0.003}}})",
            "; does hand.target lead to the surface?"},
           // The tool is on its way to a target above the surface.
           {R"({"hand": {"type": "impedance", "z_N": null, "stiffness_N_per_m": 300, "damping_N_s_per_m": 6,
                        "target": {"x_m": 0, "y_m": 0, "z_m": 0.0012}}})",
            "; does hand.target lead to the surface?"},
           {R"({"hand": {"z_N": 1}, "environment": {"type": "mesh", "file": "cube.obj", "scale": 1e-6, "size_m": null,
                                                    "spacing_m": null}})",
            "; is environment.scale right?"},
           {R"({"hand": null, "initial": null,
               "motion": {"position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": 0.003}}})",
            "; is motion.position right?"},
           // The tool starts 1.5 mm above the plane and moves down at 1 mm/s for 0.05 s.
           {R"({"hand": null, "initial": null,
               "motion": {"position": {"type": "prescribed", "x_m": 0, "y_m": 0,
                                       "z_m": {"type": "waypoints", "points": [[0, 0.0015], [1, 0.0005]]}}}})",
            "; it was approaching at the end and would touch 1.5 s later: is time.steps too small?"},
           // At a tenth of this speed, even a run that is a hundred times as long would not reach the plane.
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

/// Checks bounds of expectations. tests/data/golden/ends.txt has the texts about expectations that are not met.
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

// condition_of_metric() is stated for exactly the metrics that a scene without any of these fields lacks, and it names
// the field with which a scene has them.
TEST(MetricConditions, NameTheFieldWithWhichRunsHaveTheMetric) {
  const MetricList plain = metrics_without_values(load_scenario(find_scenario("tap_wall")));
  for (const Metric& metric : all_metrics())
    EXPECT_EQ(condition_of_metric(metric.name).empty(), find_metric(plain, metric.name) != nullptr) << metric.name;
  struct Case {
    const char *metric, *scene, *override, *field;
  };
  const Case cases[] = {
      {"energy.created_sum_J", "tap_wall", "record.energy=true", "record.energy"},
      {"torque.lost_mean_Nm", "tap_wall", "record.torque=true", "record.torque"},
      {"friction.stick_share", "tap_wall", R"(rendering.friction={"type":"dry","mu":0.2})", "rendering.friction"},
      {"contacts.age_p50_s", "tap_wall", "rendering.contacts.every=4", "rendering.contacts"},
      {"force_stage.removed_J", "tap_wall", R"(rendering.force_stage={"type":"energy_tank"})", "rendering.force_stage"},
      {"ideal_trajectory.gentle.height_error_rms_m", "rotate_in_hole", "record.ideal_trajectory=true",
       "ideal_trajectory"},
      {"fidelity.force_error_rms_N", "matching_slot", "seed=1", "reference_force"},
      {"six_dof.force_error_rms_N", "six_dof_edge", "seed=1", "six_dof"},
      {"targets.0.success_rate.mean", "vertical_peg_in_hole_shaped_stiffness", "seed=1", "tracking"}};
  for (const auto& [metric, scene, override, field] : cases) {
    ASSERT_NE(find_metric(all_metrics(), metric), nullptr) << metric;
    EXPECT_NE(condition_of_metric(metric).find(field), std::string::npos) << metric;
    const std::vector<std::string> overrides = {override};
    EXPECT_NE(find_metric(metrics_without_values(load_scenario(find_scenario(scene), overrides)), metric), nullptr)
        << metric << " in " << scene;
  }
}

Json scene() {
  return Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 5000},
    "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0001},
    "initial": {"position_m": [-0.002, 0, 0.0002]},
    "hand": {"type": "drag", "force_N": 1, "direction": [1, 0, 0], "speed_m_per_s": 0.001,
             "stiffness_N_per_m": 300, "damping_N_s_per_m": 6, "normal_damping_N_s_per_m": 50},
    "rendering": {"algorithm": "shaped_stiffness", "reduction": null, "depth_model": "normal_projection",
     "stiffness_N_per_m": 20000, "damping_ratio": 0.7,
                  "mass_kg": 0.1, "friction": {"mu_s_N_s_per_m": 5, "mu_f_s_per_m": 10}}
  })");
}

TEST(Drag, PressesWithItsForceAndLagsAsItsSpringSays) {
  for (const char* algorithm : {"shaped_stiffness", "mean", "proxy"}) {
    Json json = scene();
    json["rendering"]["algorithm"] = algorithm;
    const StepRecord last = test::rows_of(read_scenario(json, "").scenario).back();
    // On a plane all contacts have the same gradient and, with normal projection, the same depth, also at the rim of
    // the tip. Every law is therefore equivalent to one spring K and one damper B = 62.6 N s/m, whichever points are in
    // contact. Along the normal, s^2 + (B + 50) / M s + K / M has the roots -221 and -905 /s. After 2.5 s, the
    // remaining error is the rounding of a depth of 0.05 mm times K.
    EXPECT_NEAR(last.force.rendered.z(), 1.0, 1e-10) << algorithm;
    // Tangentially, the spring must overcome the friction (5 + 10 F) N s/m. The roots are -15 and -195 /s, so the
    // remaining error is exp(-15.4 * 2.5) = 2e-17.
    const double moving_point = -0.002 + 0.001 * last.time;
    EXPECT_NEAR(moving_point - last.tool.pose.position.x(), (5.0 + 10.0) * 0.001 / 300.0, 1e-12) << algorithm;
    EXPECT_NEAR(last.tool.velocity.x(), 0.001, 1e-12) << algorithm;
    EXPECT_LT((last.tool.pose.axis - Vec3(0, 0, -1)).norm(), 1e-12) << algorithm;
  }
}

std::string warnings_of(const Result& report) {
  std::string text;
  for (const Warning& warning : report.warnings) text += warning.located_text() + "\n";
  return text;
}

/// Checks paths of two to four straight legs. Each new leg turns back or to one side. A tool that lags behind the
/// moving point of the hand's spring by a fraction of its width counts as following the path, whatever the distance
/// between the start and the end of the path is. Under strong dry friction the tool follows none of the paths.
TEST(Drag, IsJudgedAlongItsPathAlsoWhereThePathReturns) {
  const std::vector<Json> paths = {
      {{-0.002, 0, 0}, {0.002, 0, 0}, {-0.002, 0, 0}},
      {{-0.002, 0, 0}, {0.002, 0, 0}, {-0.002, 0, 0}, {0.002, 0, 0}},
      {{-0.002, 0, 0}, {0.002, 0, 0}, {-0.001, 0, 0}, {0.003, 0, 0}, {-0.002, 0, 0}},
      {{-0.002, 0, 0}, {0.002, 0.0005, 0}, {-0.002, 0.001, 0}},
      {{-0.002, 0, 0}, {0.002, 0.002, 0}, {0.002, -0.002, 0}},
      {{-0.002, 0, 0}, {0.002, 0, 0}, {0.0015, 0, 0}},
  };
  const Json devices = {{{"type", "ideal"}},
                        {{"type", "impedance"}, {"handle_mass_kg", 0.1}, {"viscous_N_s_per_m", 1}}};
  for (const Json& device : devices) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Json json = scene();
      json["device"] = device;
      json["hand"].erase("direction");
      json["hand"]["path_m"] = paths[i];
      json["hand"]["speed_m_per_s"] = 0.006;
      json["rendering"]["stiffness_N_per_m"] = 2000;
      const Result followed = run_scenario(checked(read_scenario(json, "")), std::nullopt, false);
      EXPECT_EQ(followed.end.outcome, Outcome::completes) << device["type"] << " " << i << warnings_of(followed);
      json["rendering"]["friction"] = {{"type", "dry"}, {"mu", 20}};
      json["rendering"]["stiffness_N_per_m"] = 20000;  // the hand stretches the contact by 300 / 20000 of its path
      const Result held = run_scenario(checked(read_scenario(json, "")), std::nullopt, false);
      EXPECT_TRUE(held.end.outcome == Outcome::stuck || held.end.outcome == Outcome::not_dragged)
          << device["type"] << " " << i << " " << outcome_name(held.end.outcome);
    }
  }
}

TEST(Drag, WithoutAPathIsNotDraggedAndIsWarnedOfBeforeItRuns) {
  Json json = scene();
  json["hand"]["direction"] = {0, 0, 1};
  json["tool"] = {{"diameter_m", 0.0005}};
  Json to_and_fro = scene();  // both points have the same nearest position on the surface
  to_and_fro["hand"].erase("direction");
  to_and_fro["hand"]["path_m"] = {{-0.002, 0, 0.003}, {-0.002, 0, 0}};
  to_and_fro["tool"] = json["tool"];
  for (const auto& [scenario, remedy] :
       {std::pair(json, "hand.smoothing_m"), {to_and_fro, "choose its points on or near the surface"}}) {
    const LoadedScenario loaded = read_scenario(scenario, "");
    const std::vector<Warning> before = scene_facts(loaded).warnings;
    ASSERT_EQ(before.size(), 1u) << remedy;
    EXPECT_NE(before[0].text.find(remedy), std::string::npos) << before[0].text;
    const Result report = run_scenario(checked(loaded), std::nullopt, false);
    EXPECT_EQ(report.end.outcome, Outcome::not_dragged);
    EXPECT_EQ(report.unmet.size(), 1u);
    EXPECT_NE(warnings_of(report).find(remedy), std::string::npos) << warnings_of(report);
  }
  EXPECT_TRUE(scene_facts(read_scenario(scene(), "")).warnings.empty());
}

/// Checks that a run has the same outcome whatever it records, and that limit and tune judge it in the same way. The
/// drill sinks in by about its half width, so that the error of the searched depth can decide.
TEST(Outcome, IsTheSameWhateverIsRecorded) {
  const std::vector<std::string> scene = {"device={\"type\":\"impedance\",\"preset\":\"omega.3\"}",
                                          "rendering.damping_ratio=0.7", "rendering.damping_N_s_per_m=null",
                                          "time.steps=12000"};
  std::set<Outcome> outcomes;
  int deeper = 0;  // runs that complete although the recorded depth is larger than the half width
  for (int i = 0; i < 7; ++i) {
    std::vector<std::string> overrides = scene;
    overrides.push_back("rendering.stiffness_N_per_m=" + std::to_string(3080.0 + 20.0 * i));
    const CheckedScenario plain = checked(load_scenario(find_scenario("rotate_in_hole_proxy"), overrides));
    const Result run = run_scenario(plain, {}, false);
    EXPECT_EQ(stability_of(plain, make_shell(plain.scenario(), plain.files()), {}).verdict == RunVerdict::went_through,
              run.end.outcome == Outcome::went_through)
        << overrides.back();
    overrides.emplace_back("record.inside=true");
    const Result recorded =
        run_scenario(checked(load_scenario(find_scenario("rotate_in_hole_proxy"), overrides)), {}, false);
    EXPECT_EQ(outcome_name(recorded.end.outcome), outcome_name(run.end.outcome)) << overrides.back();
    outcomes.insert(run.end.outcome);
    const double depth = number_of(recorded.metrics, "inside_max_m").value();
    const bool is_missed = run.end.outcome == Outcome::completes && depth > 0.0005;
    EXPECT_EQ(warnings_of(recorded).find("the search that decides the outcome") != std::string::npos, is_missed);
    if (is_missed) ++deeper;
  }
  EXPECT_EQ(outcomes, (std::set{Outcome::completes, Outcome::went_through})) << "the scenes miss the threshold";
  EXPECT_GT(deeper, 0) << "no run is so near the threshold that the error of the search decides";
}

/// Checks a drill that rotates about its resting tip into the wall of its hole. At the end, the axis of its shank is in
/// the wall. The tip centre and the part of the axis just behind it have always been in the hole.
TEST(Outcome, OfAShankThatIsInside) {
  const LoadedScenario loaded = load_scenario(find_scenario("pure_rotation"), {});
  const Result report = run_scenario(checked(loaded), std::nullopt, false);
  EXPECT_EQ(report.end.outcome, Outcome::went_through);
  EXPECT_TRUE(report.unmet.empty());
  // At 0.2 rad the shank only presses on the rim.
  const std::vector<std::string> half = {"motion.orientation.tilt_rad=0.2", "expect={}"};
  EXPECT_EQ(run_scenario(checked(load_scenario(find_scenario("pure_rotation"), half)), std::nullopt, false).end.outcome,
            Outcome::completes);
  EXPECT_NE(warnings_of(report).find("a part of the tool was 0.86"), std::string::npos) << warnings_of(report);
}

}  // namespace
}  // namespace hapbench::outcome_test
