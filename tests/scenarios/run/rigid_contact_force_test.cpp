#include "scenarios/run/rigid_contact_force.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::rigid_contact_force_test {
namespace {

// Tests the reference force of rigid contact in a scenario, and the scenarios for which it is refused.

/// Returns the scenario of a round drill that moves down onto a cube of 10 mm and along its upper face, at a depth of
/// 0.1 mm.
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

/// Returns the scenario of a hand of 300 N/m whose target moves down to z = 5 mm and then stays there. This is 0.5 mm
/// below the lowest tip centre at which the tool does not overlap the cube.
Json held_over_a_cube(const char* algorithm, double K) {
  Json json = over_a_cube();
  json.erase("motion");
  json["initial"] = {{"position_m", {0.0, 0.0003, 0.0065}}};
  json["hand"] = Json::parse(R"({"type": "impedance", "stiffness_N_per_m": 300, "damping_N_s_per_m": 6,
      "target": {"x_m": 0, "y_m": 0.0003, "z_m": {"type": "waypoints", "points": [[0, 0.0065], [0.2, 0.005]]}}})");
  json["rendering"] = {{"algorithm", algorithm}, {"stiffness_N_per_m", K}, {"mass_kg", 0.05}};
  json["time"]["steps"] = 4000;
  json["record"] = {{"force_reference", true}};
  return json;
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
  // The tolerance is K times a rounding error, with a margin.
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

/// Checks the force error of a run with the proxy relative to the reference force. The tolerance of this metric is five
/// times the error of the reference force.
TEST(RigidContactForce, IsComparedWithTheRenderedForce) {
  Json json = over_a_cube();
  json["rendering"]["algorithm"] = "proxy";  // the proxy uses the constraints of rigid contact on points
  const Result run = run_scenario(checked(read_scenario(json, test::data_directory())), std::nullopt, false);
  const Metric* error = find_metric(run.metrics, "fidelity.force_error_rms_N");
  ASSERT_NE(error, nullptr);
  // Half the diagonal of a square of points 0.1 mm apart is 0.0707 mm. A point at this distance from the axis of a ball
  // of 0.5 mm radius rotates a force of 2 N by 0.142 rad, which is 0.28 N sideways. It also reduces the depth by 5 um,
  // which is 0.1 N.
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
  Json tremor = held_over_a_cube("mean", 5000.0);
  tremor["hand"]["tremor"] = {{"rms_m", {1e-5, 1e-5, 1e-5}}};
  EXPECT_THROW(checked(read_scenario(tremor, test::data_directory())), InputError);
  const std::string inside = refused(R"({"motion": {"position": {"z_m": 0.0054}}})");
  EXPECT_NE(inside.find("touches the mesh in the first step"), std::string::npos) << inside;
}

TEST(RigidContactForce, InAHandIsThatOfARigidToolInTheSameHand) {
  for (const double K : {5000.0, 20000.0}) {
    const LoadedScenario loaded = read_scenario(held_over_a_cube("shaped_stiffness", K), test::data_directory());
    const auto force = rigid_contact_force(loaded.scenario, loaded.files);
    // The force is the hand's stiffness times the distance of its target from the free position, 0.15 N. It does not
    // depend on K.
    EXPECT_NEAR((*force->at(1.0) - Vec3(0, 0, 300 * 0.0005)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((*force->tip_at(1.0) - Vec3(0, 0.0003, 0.0055)).norm(), 0.0, 1e-15);
    EXPECT_EQ(*force->at(0.0), Vec3(0, 0, 0));
  }
}

/// Checks the equilibrium with the proxy at the free position, k (z - z_target) = K (z_free - z): the tool is 0.5 mm k
/// / (K + k) below the free position, and the rendered force is smaller than the force of a rigid surface by the factor
/// K / (K + k).
TEST(RigidContactForce, InAHandComparesForceAndDisplacement) {
  constexpr double kK = 5000.0, kHand = 300.0;
  Json json = held_over_a_cube("proxy", kK);
  json["hand"]["target"]["z_m"] = 0.005;
  json["initial"]["position_m"] = {0.0, 0.0003, 0.0055 + 1e-9};
  json["rendering"]["damping_ratio"] = 1.0;
  const Result run = run_scenario(checked(read_scenario(json, test::data_directory())), std::nullopt, false);
  const double depth = 0.0005 * kHand / (kK + kHand);
  const double displacement = *number_of(run.metrics, "fidelity.displacement_rms_m");
  const double force = *number_of(run.metrics, "fidelity.force_error_rms_N");
  // A point of the grid of 0.1 mm lies on the tool's axis. The tool starts at the free position and is overdamped: its
  // slow time constant is below (B + b) / (K + k) = (32 + 6) / 5300 s = 7.1 ms. Therefore the mean squared displacement
  // over 2 s is smaller than the square of `depth` by a fraction of at most 2 * 7.1 ms / 2 s, and its root is smaller
  // than `depth` by half of this fraction.
  EXPECT_NEAR(displacement, depth, 0.004 * depth);
  // The rendered force rises from 0 with this time constant tau. The mean of its squared error over 2 s therefore
  // exceeds (k depth)^2, the squared error at equilibrium, by at most (0.15 N)^2 (tau / 2) / 2 s.
  EXPECT_GT(force, kHand * depth);
  EXPECT_LT(force, std::sqrt(std::pow(kHand * depth, 2) + std::pow(kHand * 0.0005, 2) * 0.0071 / 2.0 / 2.0));
  EXPECT_EQ(
      number_of(
          run_scenario(checked(read_scenario(over_a_cube(), test::data_directory())), std::nullopt, false).metrics,
          "fidelity.displacement_rms_m"),
      std::nullopt)
      << "a prescribed path";
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
