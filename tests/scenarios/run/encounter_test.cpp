#include "scenarios/run/encounter.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "results/observe/metrics.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/results/rows.hpp"

/// The outcomes of runs that miss or lose their object, whether they were expected, and the warnings about them.
namespace hapbench::encounter_test {
namespace {

/// A block of 6 x 6 x 7 mm, whose diagonal is 11 mm, and a tool of 10 mm pushed by a hand of constant force.
class EncounterWithBlock : public testing::Test {
 protected:
  EncounterWithBlock() {
    contact = {.rows = 1000, .in_contact = 49, .last = 0.249};
    approach = {0.0, 0.1, 0.0};
    scenario.environment = MeshEnvironment{"bear.off", 0.001, {}, {}};
    scenario.hand = ForceHandFields{};
    scenario.time = {0.0005, 1000, {}};
  }
  Outcome outcome() const { return outcome_of(scenario, {contact, approach, box, tool}); }
  std::string warning() const {
    return warning_about(scenario, outcome(), {contact, approach, box, tool}).value_or("no warning");
  }

  Scenario scenario;
  TrialContact contact;
  Approach approach;
  Cylinder tool;
  Box box{Vec3(0, 0, -0.007), Vec3(0.006, 0.006, 0)};
};

TEST_F(EncounterWithBlock, CompletesWhereTheToolTouchedAndStayedNear) {
  EXPECT_EQ(outcome(), Outcome::completes);
  EXPECT_EQ(warning(), "no warning");
  approach.last = 0.0209;  // retracted, by less than box and tool are long
  EXPECT_EQ(outcome(), Outcome::completes);
}

TEST_F(EncounterWithBlock, LostContactWhenTheToolEndedFarAway) {
  approach.last = 0.0211;
  EXPECT_EQ(outcome(), Outcome::lost_contact);
  EXPECT_EQ(warning(),
            "in contact for 4.9 % of the run, last at 0.249 s; ended 21.1 mm away from the environment (6 x 6 x 7 mm: "
            "x 0 ... 6, y 0 ... 6, z -7 ... 0 mm); a hand of constant force goes on pushing where there is no surface");
}

TEST_F(EncounterWithBlock, AScriptMayLeadTheToolAway) {
  scenario.motion.position = PrescribedPosition{};
  approach.last = 1.0;
  EXPECT_EQ(outcome(), Outcome::completes);
}

TEST_F(EncounterWithBlock, NoContactAsksForTheScaleWhereSizesAreOutOfProportion) {
  contact.in_contact = 0;
  approach.closest = 0.0079;
  EXPECT_EQ(outcome(), Outcome::no_contact);
  EXPECT_EQ(warning().find("scale"), std::string::npos);
  for (const double factor : {1e-3, 1e3}) {
    const Box other{factor * box.min, factor * box.max};
    const auto text = warning_about(scenario, Outcome::no_contact, {contact, approach, other, tool});
    EXPECT_NE(text.value_or("").find("; is environment.scale right?"), std::string::npos) << factor;
  }
}

TEST_F(EncounterWithBlock, NoContactTellsWhichHandNeverReaches) {
  contact.in_contact = 0;
  approach.closest = 0.002;
  ImpedanceHandFields hand;
  hand.target[2] = Profile(0.003);
  scenario.hand = hand;
  EXPECT_NE(warning().find("; hand.target stays 3 mm away from it"), std::string::npos) << warning();
  scenario.hand = NoHandFields{};
  EXPECT_NE(warning().find("; nothing pushes the tool"), std::string::npos) << warning();
}

TEST_F(EncounterWithBlock, NoContactOfAStrokeInMillimetresAsksForMetres) {
  contact.in_contact = 0;
  approach.closest = 1.5;
  scenario.motion.position = RecordedPosition{"stroke.csv"};
  EXPECT_NE(warning().find("; are the positions of motion.position.file in metres?"), std::string::npos) << warning();
}

using Sentences = std::vector<std::string>;

Result run_with_force(double force) {
  Result run;
  run.metrics = metrics_without_values();
  run.metrics.front().value = force;
  return run;
}

ExpectFields force_between(std::optional<double> min, std::optional<double> max) {
  ExpectFields expect;
  expect.metrics["force_max_N"] = MetricBound{min, max};
  return expect;
}

TEST(Expectation, IsMetByAnyOfItsOutcomes) {
  Result run = run_with_force(0.0);
  ExpectFields expect;
  for (const Outcome outcome : {Outcome::completes, Outcome::leaves_hole, Outcome::tool_horizontal}) {
    run.end.outcome = outcome;
    EXPECT_EQ(unmet_expectations(expect, run), Sentences{});
  }
  expect.outcomes = {Outcome::diverges};
  EXPECT_EQ(unmet_expectations(expect, run), Sentences{"outcome is \"tool_horizontal\"; expected \"diverges\""});
}

TEST(Expectation, OfNoDivergenceSaysWhatDiverged) {
  Result run = run_with_force(0.0);
  run.end.outcome = Outcome::diverges;
  run.end.divergence = {17, 0.0085, "velocity", 2e6, 1e6};
  EXPECT_EQ(
      unmet_expectations({}, run),
      Sentences{"outcome is \"diverges\" (velocity reached 2e+06 at step 17, beyond 1e+06); expected \"completes\", "
                "\"leaves_hole\", \"tool_horizontal\""});
}

TEST(Expectation, IncludesItsBounds) {
  for (const auto& bounds :
       {force_between(2.0, 2.0), force_between({}, 2.0), force_between(2.0, {}), force_between({}, {})}) {
    EXPECT_EQ(unmet_expectations(bounds, run_with_force(2.0)), Sentences{});
  }
  EXPECT_EQ(unmet_expectations(force_between(2.5, {}), run_with_force(2.0)),
            Sentences{"force_max_N is 2; expected at least 2.5"});
  EXPECT_EQ(unmet_expectations(force_between({}, 1.5), run_with_force(2.0)),
            Sentences{"force_max_N is 2; expected at most 1.5"});
}

TEST(Expectation, OfAMetricWithoutValueIsNotMet) {
  ExpectFields expect;
  expect.metrics["ratio_max"] = MetricBound{{}, 2.0};
  EXPECT_EQ(unmet_expectations(expect, run_with_force(0.0)), Sentences{"ratio_max has no value; expected one"});
}

TEST(Expectation, MayBoundEveryMetricThatIsANumber) {
  for (const std::string& name : metric_names()) {
    ExpectFields expect;
    expect.metrics[name] = MetricBound{1e15, {}};
    EXPECT_EQ(unmet_expectations(expect, run_with_force(0.0)).size(), 1u) << name;
  }
  EXPECT_GE(metric_names().size(), 12u);
}

/// A row of points along x, a millimetre apart, the mesh being open at x = 0.
class OpenEdges : public testing::Test {
 protected:
  OpenEdges() : shell_(points(), 0.0), observer_(shell_, {Vec3::Zero()}, 0.002) {}

  static std::vector<SurfacePoint> points() {
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 20; ++i) points.push_back({{0.001 * i, 0, 0}, Vec3::UnitZ()});
    return points;
  }
  void touch(std::uint32_t point) {
    ContactBuffer contacts(1);
    contacts.push(point, shell_.point(point).position, Vec3::UnitZ());
    observer_.on_step(test::row(row_, 0.5 * static_cast<double>(row_), contacts));
    ++row_;
  }

  PointShell shell_;
  OpenEdgeObserver observer_;
  std::uint64_t row_ = 0;
};

TEST_F(OpenEdges, FarFromThemNothingIsSaid) {
  for (std::uint32_t i = 3; i < 20; ++i) touch(i);
  EXPECT_EQ(observer_.warning(), std::nullopt);
}

TEST_F(OpenEdges, NearThemTheFirstTouchIsTold) {
  touch(9);
  touch(2);
  touch(0);
  EXPECT_EQ(observer_.warning(),
            "touched the mesh within 2 mm of where it is open in 2 rows, first at 0.5 s near (2, 0, 0) mm: beyond the "
            "edge there is no surface");
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
  const Result report = run_scenario(read_scenario(json, HAPBENCH_TEST_DATA), std::nullopt, false);
  EXPECT_EQ(report.work.allocations, 0u);
  EXPECT_EQ(report.end.outcome, Outcome::completes);
  // Lowered at 20 mm/s it is on the cube after a tenth of a second.
  EXPECT_GT(number_of(report.metrics, "steps_in_contact"), 4500.0);
}

std::string warnings_of(const Result& report) {
  std::string text;
  for (const std::string& warning : report.warnings) text += warning + "\n";
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
  const Result report = run_scenario(read_scenario(json, ""), std::nullopt, false);
  EXPECT_EQ(report.end.outcome, Outcome::not_dragged);
  EXPECT_NE(warnings_of(report).find("the tool stood still since"), std::string::npos) << warnings_of(report);
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
    const Result report = run_scenario(loaded, std::nullopt, false);
    EXPECT_EQ(report.end.outcome, Outcome::not_dragged);
    EXPECT_EQ(report.unmet.size(), 1u);
    EXPECT_NE(warnings_of(report).find(remedy), std::string::npos) << warnings_of(report);
  }
  EXPECT_TRUE(scene_facts(read_scenario(scene(), "")).warnings.empty());
}

TEST(Drag, TellsOfAToolThatWentThrough) {
  Json json = scene();
  json["hand"]["force_N"] = 50;
  json["rendering"]["stiffness_N_per_m"] = 100;
  json["tool"] = {{"diameter_m", 0.0005}};
  const Result report = run_scenario(read_scenario(json, ""), std::nullopt, false);
  EXPECT_EQ(report.end.outcome, Outcome::went_through);
  ASSERT_EQ(report.warnings.size(), 1u) << warnings_of(report);
  EXPECT_NE(warnings_of(report).find("the tool went through the surface: its tip centre was more than its half width"),
            std::string::npos)
      << warnings_of(report);
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

/// The approach of a tool whose tip centre is at these places, a second apart, to the cube from -1 to 1.
Approach approach_of(const std::vector<Vec3>& places) {
  const ContactBuffer none(1);
  ApproachObserver observer({-Vec3::Ones(), Vec3::Ones()});
  for (std::size_t k = 0; k < places.size(); ++k) {
    StepRecord row = test::row(k, static_cast<double>(k), none);
    row.tool.pose.position = places[k];
    observer.on_step(row);
  }
  return observer.approach();
}

TEST(Approach, IsMeasuredFromTheBoxInEveryDirection) {
  EXPECT_EQ(approach_of({{0, 0, 3}}).last, 2.0);
  EXPECT_EQ(approach_of({{-4, 0, 5}}).last, 5.0);  // from an edge
  EXPECT_EQ(approach_of({{3, 4, -3}}).last, std::sqrt(4.0 + 9.0 + 4.0));
  EXPECT_EQ(approach_of({{0.5, -1, 0}}).last, 0.0);
}

TEST(Approach, KeepsTheFirstOfTheClosestRows) {
  const Approach approach = approach_of({{0, 0, 9}, {0, 0, 3}, {3, 0, 0}, {0, 7, 0}});
  EXPECT_EQ(approach.closest, 2.0);
  EXPECT_EQ(approach.closest_time, 1.0);
  EXPECT_EQ(approach.last, 6.0);
}

}  // namespace
}  // namespace hapbench::encounter_test
