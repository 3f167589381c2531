#include "scenarios/run/rigid_contact_force.hpp"

#include <gtest/gtest.h>

#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::rigid_contact_force_test {
namespace {

// Tests the reference force of rigid contact in a scenario, and the scenarios for which it is refused.

/// A round drill that moves down onto a cube of 10 mm and along its upper face, at a depth of 0.1 mm.
Json over_a_cube() {
  return Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 1000},
    "environment": {"type": "mesh", "file": "cube.obj", "scale": 0.001, "spacing_m": 0.0001},
    "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
    "motion": {"position": {"type": "prescribed",
      "x_m": {"type": "waypoints", "points": [[0.2, -0.002], [0.5, 0.002]]}, "y_m": 0.0003,
      "z_m": {"type": "waypoints", "points": [[0, 0.0065], [0.2, 0.0054]]}}},
    "rendering": {"stiffness_N_per_m": 20000, "damping_ratio": 0},
    "reference_force": {"type": "rigid_contact"}
  })");
}

Scenario scene(const Json& json) {
  return read_scenario(json, test::data_directory()).scenario;
}

std::string refused(const char* patch) {
  Json json = over_a_cube();
  json.merge_patch(Json::parse(patch));
  const auto error = test::input_error_of(
      [&] { run_scenario(checked(read_scenario(json, test::data_directory())), std::nullopt, false); });
  return error ? error->what() : "";
}

TEST(RigidContactForce, OnAFaceIsStiffnessTimesDepth) {
  const LoadedScenario loaded = read_scenario(over_a_cube(), test::data_directory());
  const auto force = rigid_contact_force(loaded.scenario, loaded.files);
  EXPECT_EQ(*force->at(0.0), Vec3(0, 0, 0)) << "outside";
  // K times a rounding error of 1e-17 m.
  for (const double t : {0.25, 0.3, 0.4995}) EXPECT_NEAR((*force->at(t) - Vec3(0, 0, 2)).norm(), 0.0, 1e-10) << t;
  EXPECT_GT(force->error(), 0.0);
  EXPECT_LT(force->error(), 1e-9);
}

TEST(RigidContactForce, DoesNotDependOnTheLawAndScalesWithK) {
  Json json = over_a_cube();
  json["rendering"]["algorithm"] = "summation";
  json["rendering"]["stiffness_N_per_m"] = 5000;
  const LoadedScenario loaded = read_scenario(json, test::data_directory());
  EXPECT_NEAR(rigid_contact_force(loaded.scenario, loaded.files)->at(0.3)->z(), 0.5, 1e-10);
}

/// The fidelity of a run for two laws, with its tolerance of ten times the error of the reference.
TEST(RigidContactForce, IsComparedWithTheRenderedForce) {
  Json json = over_a_cube();
  json["rendering"]["algorithm"] = "proxy";  // the proxy uses the constraints of rigid contact on points
  const Result run = run_scenario(checked(read_scenario(json, test::data_directory())), std::nullopt, false);
  const Metric* error = find_metric(run.metrics, "fidelity.force_error_rms_N");
  ASSERT_NE(error, nullptr);
  // Half the diagonal of a square of points 0.1 mm apart is 0.0707 mm. A point at this distance from the axis of a ball
  // of 0.5 mm rotates a force of 2 N by 0.142 rad, which is 0.28 N sideways. It also reduces the depth by 5 um, which
  // is 0.1 N.
  EXPECT_LT(*number_of(error->value), 0.3);
  const Json summary = summary_json(run);
  const double reference_error = summary["fidelity"]["reference_error_N"].get<double>();
  EXPECT_DOUBLE_EQ(*error->tolerance(), 5.0 * reference_error);
}

TEST(RigidContactForce, RefusesByNameWhatItDoesNotCover) {
  EXPECT_NE(refused(R"({"tool": {"tip": "flat"}})").find("/reference_force/type"), std::string::npos);
  const std::string bur = refused(R"({"tool": {"type": "bur", "family": "ball", "length_m": null, "tip": null}})");
  EXPECT_NE(bur.find("revolved, bur and mesh"), std::string::npos) << bur;
  const std::string plane =
      refused(R"({"environment": {"type": "plane", "file": null, "scale": null, "size_m": 0.01}})");
  EXPECT_NE(plane.find("environment.type \"mesh\""), std::string::npos) << plane;
  const std::string free = refused(R"({"motion": null})");
  EXPECT_NE(free.find("/reference_force"), std::string::npos) << free;
  const std::string inside = refused(R"({"motion": {"position": {"z_m": 0.0054}}})");
  EXPECT_NE(inside.find("touches the mesh in the first step"), std::string::npos) << inside;
}

TEST(RigidContactForce, ShiftsWithThePath) {
  Json json = over_a_cube();
  json["motion"]["position"]["shift_m"] = {0.001, 0.0, -0.00005};
  const Scenario shifted = scene(json);
  const LoadedScenario loaded = read_scenario(json, test::data_directory());
  EXPECT_NEAR(rigid_contact_force(shifted, loaded.files)->at(0.3)->z(), 3.0, 1e-10);
}

}  // namespace
}  // namespace hapbench::rigid_contact_force_test
