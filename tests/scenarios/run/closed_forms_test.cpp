#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "tests/scenarios/support/bundled.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::closed_forms_test {
namespace {

using test::bundled;
using test::rows_of;

// Compares bundled scenarios with closed forms. Bilateral springs are compared with the linear recurrence (x, v) <- A
// (x, v) of one spring-damper under the integrator, with the matrix A of Eq. A.2. Another test simulates ten minutes in
// contact.

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

struct State {
  double x, v;
};

/// Returns the right-hand side of Eq. A.2, in the order in which the thesis prints it.
State after_one_step(const State& s, double K, double B, double M, double dt) {
  return {(1.0 - K * dt * dt / M) * s.x + (dt - B * dt * dt / M) * s.v, -K * dt / M * s.x + (1.0 - B * dt / M) * s.v};
}

TEST(OneSpringDamper, FollowsEquationA2ToRounding) {
  const double K = 20000.0, M = 0.1, dt = 0.0005, B = 2.0 * 0.7 * std::sqrt(K * M);
  const auto rows = rows_of(bundled("single_spring", {"time.steps=2000", "initial.velocity_m_per_s=[0.5,0,0]"}));
  ASSERT_EQ(rows.size(), 2000u);
  State expected{1e-3, 0.5};
  // In each step, the simulation and the recurrence together make about 8 rounding errors relative to the current
  // state. The eigenvalues of A have the modulus rho = sqrt(1 - B dt / M) = 0.83. After k steps, an error has grown by
  // a factor of k rho^k, which is at most 2. A factor of 4 allows for powers of A that are larger than the powers of
  // its eigenvalues. In total, the error is 8 * 2 * 4 units in the last place of the largest state.
  const double x_tolerance = 64 * kEpsilon * 1e-3, v_tolerance = 64 * kEpsilon * 1e-3 / dt;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_NEAR(rows[k].tool.pose.position.x(), expected.x, x_tolerance) << k;
    ASSERT_NEAR(rows[k].tool.velocity.x(), expected.v, v_tolerance) << k;
    ASSERT_EQ(rows[k].tool.pose.position.tail<2>(), Eigen::Vector2d::Zero()) << k;
    expected = after_one_step(expected, K, B, M, dt);
  }
  EXPECT_LT(std::abs(expected.x), 1e-100);  // the mass comes to rest
}

/// Returns the steady response x_k of a spring-damper to the force F_k = mean + amplitude sin(w k dt). The integrator
/// computes (M/dt²)(x_(k+1) - 2 x_k + x_(k-1)) + (B/dt)(x_k - x_(k-1)) + K x_k = F_k. The response to a force z^k is a
/// multiple of z^k, here with z = exp(i w dt).
double steady_response(double K, double B, double M, double dt, const Profile::Sine& force, double k) {
  const double angle = 2.0 * std::numbers::pi / force.period_s * dt;
  const std::complex<double> z = std::polar(1.0, angle);
  const std::complex<double> dynamic_stiffness = (M / (dt * dt)) * (z - 2.0 + 1.0 / z) + (B / dt) * (1.0 - 1.0 / z) + K;
  return force.mean / K + (force.amplitude * std::polar(1.0, angle * k) / dynamic_stiffness).imag();
}

TEST(TenMinutesInContact, EndWhereTheClosedFormSaysAndMakeNoEnergy) {
  const LoadedScenario loaded = load_scenario(find_scenario("ten_minutes_in_contact"));
  const Scenario& scenario = loaded.scenario;
  const Result report = run_scenario(checked(loaded), std::nullopt, false);
  EXPECT_EQ(report.unmet, std::vector<std::string>{});
  EXPECT_EQ(report.end.rows, 1'200'000u);

  const double K = scenario.rendering.stiffness, M = scenario.rendering.mass;
  const double B = 2.0 * scenario.rendering.damping_ratio * std::sqrt(K * M);
  const auto& force = std::get<Profile::Sine>(std::get<ForceHandFields>(scenario.hand).force[2].shape());
  const double expected = steady_response(K, B, M, scenario.time.step, force, 1'199'999.0);
  // The transient has decayed to e^(-100 000) of its initial amplitude. The rounding errors of position and force, each
  // 1e-16 times 0.3 mm, decay within a hundred steps. The phase of the sine, 5386 rad, has a rounding error of 1e-12
  // rad, which changes the position by 1e-12 times the amplitude of 0.05 mm.
  EXPECT_NEAR(number_of(report.metrics, "final_position_m.z").value(), expected, 1e-15);
  const auto& bound = scenario.expect.metrics.at("final_position_m.z");
  EXPECT_NEAR(0.5 * (*bound.min + *bound.max), expected, 1e-14) << "the file's bounds are about the closed form";

  // The only energy created in a step is the rounding error of the sums of the energy balance, which have terms up to 3
  // mJ: 1e-18 J in each of 1.2 million steps.
  EXPECT_LE(number_of(report.metrics, "energy.created_sum_J").value(), 1.2e-12);
}

// Compares scenes of dry friction with closed forms.

std::string number(const char* field, double value) {
  return std::string(field) + "=" + std::to_string(value);
}

/// Checks the load at which a jammed peg slips. The points of each wall lie at y = 0, +-0.1 mm, +-0.2 mm and so on.
/// Their depth in the peg is the radius minus their distance from the peg's axis. `mean` gives each point the weight
/// 1/n, so the loads add up to K times the mean depth.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): checks every gap and coefficient.
TEST(PegThatJams, SlipsAtMuTimesTheLoadsOfBothWalls) {
  for (const double gap : {0.00085, 0.0009, 0.00096}) {
    double sum = 0.0, n = 0.0;
    for (int i = -5; i <= 5; ++i) {
      const double depth = 0.0005 - std::hypot(0.5 * gap, 1e-4 * i);
      if (depth > 0.0) sum += depth, ++n;
    }
    for (const double mu : {0.1, 0.3, 0.5}) {
      SCOPED_TRACE(testing::Message() << gap << " " << mu);
      const double slips_at = mu * 20000.0 * sum / n / 0.6;  // the push increases by 0.6 N/s
      const auto rows =
          rows_of(bundled("peg_jams_dry", {number("environment.gap_m", gap), number("rendering.friction.mu", mu),
                                           number("time.duration_s", slips_at + 0.05)}));
      double slipped = 0.0;
      for (const StepRecord& row : rows) {
        if (row.force.friction == Friction::slides && slipped == 0.0) slipped = row.time;
      }
      // While the push grows by 0.6 N/s, the bristle's damper bears 0.6 N/s B_t / K_t, which is less than 1 mN. This
      // delays the slip by less than 2 ms. The tolerance is this delay plus a margin of 1 ms.
      EXPECT_NEAR(slipped, slips_at, 0.003);
      // Before the slip, the peg creeps by at most the deflection of the bristle, mu N / K_t. After the slip, it moves
      // further.
      const double until = slips_at - 0.005;
      for (const StepRecord& row : rows) {
        if (row.time < until) {
          ASSERT_GE(row.tool.pose.position.z(), -0.004 - mu * sum / n * 1.05) << row.time;
        }
      }
      EXPECT_LT(rows.back().tool.pose.position.z(), -0.004 - 1.1 * mu * sum / n);
    }
  }
}

/// Checks that a peg that is pushed into a taper of half angle w and then released stays if and only if mu > sin w /
/// cos^2 w. The sum N of the loads on both faces pushes the peg out with the force N sin w. The law has one bristle for
/// the whole tool and projects its force with P = I - sum N_i u_i u_i^T / N. Along the exit direction, P is cos^2 w, so
/// friction holds the peg with at most mu N cos^2 w. With separate Coulomb friction on each face, the peg would already
/// stay if mu > tan w.
TEST(PegInATaper, LocksItselfFromTheClosedFormOn) {
  for (const double w : {0.1, 0.2, 0.4}) {
    const double locks = std::sin(w) / (std::cos(w) * std::cos(w));
    EXPECT_GT(locks, std::tan(w));
    for (const double factor : {0.97, 1.03}) {
      SCOPED_TRACE(testing::Message() << w << " " << factor);
      const std::string c = std::to_string(std::cos(w)), s = std::to_string(std::sin(w));
      const auto rows = rows_of(bundled(
          "stick_slip_dry", {R"(environment={"type":"springs","bilateral":false,"groups":[{"direction":[)" + c +
                                 ",0,-" + s + R"(],"count":1},{"direction":[-)" + c + ",0,-" + s + R"(],"count":1}]})",
                             "initial.position_m=[0,0,0]", "rendering.algorithm=summation", "time.duration_s=1.5",
                             number("rendering.friction.mu", factor * locks),
                             R"(hand={"type":"force","z_N":{"type":"waypoints","points":[[0,0],[0.3,-5],[0.6,0]],)"
                             R"("interpolation":"cosine"}})"}));
      EXPECT_EQ(rows.back().tool.pose.position.z() < -1e-6, factor > 1.0) << rows.back().tool.pose.position.z();
    }
  }
}

/// Checks the period of stick-slip. A spring whose end moves at the speed V pulls the block. The block slips when the
/// spring force is mu N, moves with the velocity V (1 - cos w t) with w = sqrt(k/M), and therefore comes to rest every
/// 2 pi / w. At rest, the spring force is mu N again and grows. With a single friction coefficient, the block therefore
/// slips again at once.
TEST(StickSlip, HasThePeriodOfSpringAndMass) {
  for (const double k : {100.0, 200.0, 400.0}) {
    for (const double mass : {0.05, 0.1}) {
      SCOPED_TRACE(testing::Message() << k << " " << mass);
      const double deep = k * 0.01 / (20000.0 + k), load = 20000.0 * deep, V = 0.01;
      const auto rows =
          rows_of(bundled("stick_slip_dry", {number("hand.stiffness_N_per_m", k), number("rendering.mass_kg", mass),
                                             "initial.position_m=[0,0,-" + std::to_string(deep) + "]"}));
      const double slips_at = 0.3 * load / (k * V), period = 2.0 * std::numbers::pi * std::sqrt(mass / k);
      std::vector<double> stands;
      for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
        const double v = rows[i].tool.velocity.x();
        if (rows[i].time > slips_at + 0.3 * period && v <= rows[i - 1].tool.velocity.x() &&
            v < rows[i + 1].tool.velocity.x())
          stands.push_back(rows[i].time);
        ASSERT_LE(v, 2.05 * V);
      }
      ASSERT_GT(stands.size(), 5u);
      // Each time of rest is known to within one time step. Before the first slip, the bristle deflects by mu N / K_t,
      // a small fraction of the spring's stretch mu N / k. This shifts the first time of rest.
      EXPECT_NEAR(stands.front(), slips_at + period, 0.02 * slips_at + 0.001);
      EXPECT_NEAR((stands.back() - stands.front()) / static_cast<double>(stands.size() - 1), period,
                  0.001 / static_cast<double>(stands.size() - 1) + 1e-4 * period);
      for (const StepRecord& row : rows) {
        if (row.time < 0.98 * slips_at) {
          ASSERT_NE(row.force.friction, Friction::slides) << row.time;
        }
      }
    }
  }
}

// Tests the guarantees of the proxy over whole runs.

LoadedScenario with_algorithm(const char* scenario, const char* algorithm) {
  const std::vector<std::string> overrides = {std::string("rendering.algorithm=") + algorithm};
  return load_scenario(find_scenario(scenario), overrides);
}

/// A proxy counts as outside the shell if no shell point is deeper in it than this depth [m]. The depth allows for the
/// rounding of the proxy's position and for kViolationTolerance times a move of at most a millimetre.
constexpr double kOutside = 1e-9;
/// Depth [m] of a shell point in the drill's proxy above which the proxy leaves the shell at a limited speed: the
/// distance that the proxy moves in one step at kProxyRecoverySpeed.
constexpr double kRecovery = 1e-5;

/// Finds shell points in the proxy by brute force. The position of the proxy follows from the position p of the tool
/// and the spring force: p + f_spring / K.
class PointsInProxy final : public Observer {
 public:
  PointsInProxy(const PointShell& shell, const SimulationParts& parts, double K)
      : query_(make_contact_query(shell, *parts.tool, Skips::off)),
        contacts_(query_->capacity()),
        tool_(parts.tool.get()),
        algorithm_(parts.algorithm.get()),
        K_(K) {}

  void on_step(const StepRecord& record) noexcept override {
    const ToolPose proxy{record.tool.pose.position + record.force.spring / K_, record.tool.pose.axis};
    query_->contacts_at(proxy, contacts_);
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
  bool cleared = false;  ///< true as soon as no point was inside the proxy in a step
  std::uint64_t steps_until_clear = 0, most_passes = 0;
  double deepest = 0.0;  ///< largest depth after the proxy was clear [m]
  double fastest = 0.0;  ///< largest speed of a proxy that leaves slowly [m/s]
  double stiffest = 0.0, largest_force = 0.0;

 private:
  std::unique_ptr<ContactQuery> query_;
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
  double allowed = kOutside;  ///< allowed depth of a point in the proxy [m]
};
/// Allowed depth [m] of a shell point in a proxy that is in a corner. The proxy avoids overlap with the shell points
/// and with a flat patch of surface around each point. In a corner, it may be able to avoid the points but not the
/// patches. The overlap, at most a tenth of the point spacing, is then shared between patches and points.
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
  // At the start, shell points are up to 22 um deep in the tools. The proxy leaves the shell by 10 um per step.
  EXPECT_LE(points.steps_until_clear, 10u);
  EXPECT_LE(points.deepest, GetParam().allowed);
  EXPECT_LE(points.stiffest, 1.0 + 1e-12);
  EXPECT_LE(points.most_passes, 10u);
}

/// Checks a peg that is as wide as its hole. At the start, the peg is tilted by 0.1 rad, its tip touches both walls,
/// and at the mouth one wall is 0.4 mm deep in the peg. While the peg is tilted, it does not fit into the hole.
TEST(ProxyInATightHole, LeavesSlowly) {
  const PointsInProxy points = watch("peg_in_hole_2d_shaped_stiffness", 2'000);
  // The move of the proxy is only approximately proportional to the depths, so its speed may exceed 0.02 m/s by a
  // tenth.
  EXPECT_LE(points.fastest, 1.1 * 0.02);
  EXPECT_LE(points.largest_force, 2.0);
}

TEST(ProxyInHole, IsFiveTimesNearerToTheIdealTrajectoryThanShapingAndVibratesLess) {
  const auto summary = [](const char* algorithm) {
    return run_scenario(checked(with_algorithm("rotate_in_hole_proxy", algorithm)), std::nullopt, false);
  };
  const Result proxy = summary("proxy"), shaped = summary("shaped_stiffness");
  const char* height_rms = "ideal_trajectory.firm.height_error_rms_m";
  EXPECT_LE(number_of(proxy.metrics, height_rms).value(), 0.00015);
  EXPECT_GE(number_of(shaped.metrics, height_rms).value(), 5.0 * number_of(proxy.metrics, height_rms).value());
  for (const char* name : {"vibration_power_above_30Hz_m2_per_s2", "velocity_total_variation_m_per_s"})
    EXPECT_LE(number_of(proxy.metrics, name).value(), number_of(shaped.metrics, name).value()) << name;
}

}  // namespace
}  // namespace hapbench::closed_forms_test
