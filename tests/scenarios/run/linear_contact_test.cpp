#include "scenarios/run/linear_contact.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/results/files.hpp"

namespace hapbench::linear_contact_test {
namespace {

constexpr double kForce = 1.3, kRadius = 0.003, kMass = 0.08, kZeta = 0.3, kStep = 0.001;

/// Returns the scenario of a ball that a constant force presses with the law `proxy` on a plane. The origin is a point
/// of the plane.
CheckedScenario pressed_ball(double stiffness) {
  Json json = Json::parse(R"({
    "environment": {"type": "plane", "size_m": 0.02, "spacing_m": 0.0005},
    "tool": {"length_m": 0.03, "tip": "round"}, "initial": {"position_m": [0, 0, 0.0031]},
    "hand": {"type": "force"},
    "rendering": {"algorithm": "proxy", "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}
  })");
  json["time"] = {{"step_s", kStep}, {"duration_s", 2}};
  json["tool"]["diameter_m"] = 2.0 * kRadius;
  json["hand"]["z_N"] = -kForce;
  json["rendering"]["stiffness_N_per_m"] = stiffness;
  json["rendering"]["damping_ratio"] = kZeta;
  json["rendering"]["mass_kg"] = kMass;
  return checked(read_scenario(json, ""));
}

/// Returns the state of a ball that touches the plane at a lateral distance `aside` [m] from the point at the origin.
ContactState touching(double aside) {
  ContactState state;
  state.pose.position = {aside, aside, 0.999 * kRadius};
  return state;
}

/// Checks that a proxy has no stiffness and no damping along a plane, also exactly above a point of the plane. A proxy
/// that passes this point is tilted for some steps, which gives a force of kForce / kRadius times the distance from the
/// point. This force depends on the direction of the motion and vanishes at rest, so it is no stiffness.
TEST(LinearContact, OfAProxyHasNoSlopeAlongAPlane) {
  for (const double aside : {0.0, 1e-4})
    for (const double K : {500.0, 603.0, 4217.0, 6000.0, 50000.0}) {
      const CheckedScenario scenario = pressed_ball(K);
      const auto shell = make_shell(scenario.scenario(), scenario.files());
      const auto at_rest = linear_contact(scenario, shell, touching(aside));
      ASSERT_TRUE(at_rest && at_rest->is_equilibrium) << K;
      // The tolerances are the relative error of the central differences.
      const double B = normal_damping(scenario.scenario().rendering);
      const LinearForce& rendered = at_rest->contact.rendered;
      const Mat3 normal = Vec3::UnitZ() * Vec3::UnitZ().transpose();
      EXPECT_LE((rendered.stiffness - K * normal).cwiseAbs().maxCoeff(), 1e-7 * K) << aside << " " << K;
      EXPECT_LE((rendered.damping - B * normal).cwiseAbs().maxCoeff(), 1e-7 * B) << aside << " " << K;
    }
}

/// Compares the limit of a proxy with the limit of one spring and damper under the integrator leapfrog, which satisfies
/// 4 - 2 B T / M - K T^2 / M = 0 with B = 2 zeta sqrt(K M).
TEST(LinearContact, OfAProxyAboveAPointHasTheLimitOfASpring) {
  const double closed = 4.0 * kMass / (kStep * kStep) * std::pow(std::hypot(1.0, kZeta) - kZeta, 2);
  for (const double aside : {0.0, 1e-4})
    for (const double K : {0.6 * closed, 1.1 * closed}) {
      const CheckedScenario scenario = pressed_ball(K);
      const auto shell = make_shell(scenario.scenario(), scenario.files());
      const auto limit = linear_stiffness_limit(scenario, shell, touching(aside));
      ASSERT_TRUE(limit) << K;
      EXPECT_NEAR(*limit, closed, 1e-7 * closed) << aside << " " << K;  // error of the central differences
    }
}

/// Writes a mesh of the top of a sphere with a radius of 10 mm, whose top is at z = 10 mm.
void write_dome(const std::filesystem::path& file) {
  constexpr int kHalf = 15, kCells = 2 * kHalf;  // number of cells along each axis
  std::string text;
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      const double x = 2e-4 * (i - kHalf), y = 2e-4 * (j - kHalf);
      text += fmt::format("v {} {} {}\n", x, y, std::sqrt(1e-4 - x * x - y * y));
    }
  const auto vertex = [](int i, int j) { return i * (kCells + 1) + j + 1; };
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      text += fmt::format("f {} {} {}\nf {} {} {}\n", vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1),
                          vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
  test::write_plainly(file, text);
}

/// Checks a ball that a constant force presses on the top of a dome. At any K, the ball drifts down the dome: real
/// eigenvalues of 1.01 per step of 1 ms, which are no vibration. The limit of the vibration along the normal is 2 b / T
/// for the combined stiffness of the contacts, which is between K / 2 and K: the normals of all contacts are at most 45
/// degrees from the force.
TEST(LinearContact, OfABallOnADomeHasTheLimitOfItsVibration) {
  constexpr double kViscous = 3.0, kLowest = 2.0 * kViscous / kStep;
  const test::TemporaryDirectory folder;
  write_dome(folder / "dome.obj");
  Json json = Json::parse(R"({
    "environment": {"type": "mesh", "file": "dome.obj", "scale": 1, "spacing_m": 0.0002},
    "initial": {"position_m": [0, 0, 0.0111]},
    "tool": {"diameter_m": 0.002, "length_m": 0.02, "tip": "round"}, "hand": {"type": "force", "z_N": -1},
    "device": {"type": "impedance", "handle_mass_kg": 0.2, "coulomb_N": 0, "encoder_step_m": 0},
    "rendering": {"algorithm": "shaped_stiffness", "damping_ratio": 0,
                  "friction": {"mu_s_N_s_per_m": 3, "mu_f_s_per_m": 0}}
  })");
  json["time"] = {{"step_s", kStep}, {"duration_s", 0.6}};
  json["device"]["viscous_N_s_per_m"] = kViscous;
  for (const double K : {9000.0, 12000.0, 20000.0}) {
    json["rendering"]["stiffness_N_per_m"] = K;
    const CheckedScenario scenario = checked(read_scenario(json, folder.path()));
    ContactState near;
    near.pose.position = {0, 0, 0.0107};
    const auto limit = linear_stiffness_limit(scenario, make_shell(scenario.scenario(), scenario.files()), near);
    ASSERT_TRUE(limit) << K;
    EXPECT_GE(*limit, kLowest) << K;
    EXPECT_LE(*limit, 2.0 * kLowest) << K;
    const Result result = run_scenario(scenario, {}, false, nullptr, Diagnose::everything);
    for (const Diagnosed& found : *result.diagnosis) {
      EXPECT_NE(found.rule, "loop") << K;
      EXPECT_TRUE(found.rule != "edge" || found.value <= K / kLowest) << K << ": " << found.value;
    }
  }
}

/// Returns the value of the rule `edge` in a run at `stiffness` that passes through the surface; 0 without a finding. A
/// hand presses a ball with the law `summation`. The unstable loop throws the ball metres away. It then falls through
/// the plane and touches the plane's points from below.
double edge_after_passage(double stiffness) {
  Json json = Json::parse(R"({
    "time": {"step_s": 0.001, "duration_s": 2},
    "environment": {"type": "plane", "size_m": 0.02, "spacing_m": 0.0005},
    "tool": {"diameter_m": 0.006, "length_m": 0.03, "tip": "round"}, "initial": {"position_m": [0, 0, 0.0031]},
    "hand": {"type": "mass_spring_damper", "mass_kg": 0.24, "stiffness_N_per_m": 570, "damping_N_s_per_m": 2.4,
             "target": {"x_m": 0, "y_m": 0, "z_m": -0.002}},
    "device": {"type": "impedance", "handle_mass_kg": 0.32, "viscous_N_s_per_m": 2, "delay_samples": 0,
               "velocity_filter": {"type": "difference"}},
    "rendering": {"algorithm": "summation", "damping_ratio": 0.7, "mass_kg": 0.034,
                  "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}
  })");
  json["rendering"]["stiffness_N_per_m"] = stiffness;
  const Result result = run_scenario(checked(read_scenario(json, "")), {}, false, nullptr, Diagnose::everything);
  EXPECT_EQ(result.end.outcome, Outcome::went_through) << stiffness;
  for (const Diagnosed& found : *result.diagnosis)
    if (std::string(found.rule) == "edge") return found.value;
  return 0.0;
}

/// Checks that the rule `edge` linearises a contact before the passage through the surface: K divided by the number of
/// the rule is the same limit in all runs.
TEST(LinearContact, OfARunThroughTheSurfaceIsAContactBeforeThePassage) {
  const double stiffness = 210000.0, edge = edge_after_passage(stiffness);
  EXPECT_GT(edge, 1.0);
  EXPECT_LT(edge, 2.0);
  // The numbers have six digits.
  for (const double factor : {0.95, 1.1, 1.2, 1.3})
    EXPECT_NEAR(edge_after_passage(factor * stiffness), factor * edge, 2e-5 * edge) << factor;
}

}  // namespace
}  // namespace hapbench::linear_contact_test
