#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"
#include "sim/core/random.hpp"
#include "tests/scenarios/support/errors.hpp"

/// Limits of the integrator on springs, and the linear loops of devices against the simulation that scenarios are run
/// by.
namespace hapbench::stability_limits_test {
namespace {

Scenario single_spring(const std::vector<std::string>& overrides = {}) {
  return load_scenario(find_scenario("single_spring"), overrides).scenario;
}

std::map<StabilityCase, StabilityLimit> limits_of(const Scenario& scenario) {
  std::map<StabilityCase, StabilityLimit> limits;
  for (const StabilityLimit& limit : stability_limits(scenario)) limits.emplace(limit.which, limit);
  EXPECT_EQ(limits.size(), 4u);
  return limits;
}

/// The limits of the scenario as it is, computed once.
const std::map<StabilityCase, StabilityLimit>& plain_limits() {
  static const auto limits = limits_of(single_spring());
  return limits;
}

/// Each limit found three ways, which agree to 1 %: bisection stops at 1e-4.
void expect_three_ways_to_agree(const std::map<StabilityCase, StabilityLimit>& limits) {
  for (const auto& [which, limit] : limits) {
    EXPECT_NEAR(limit.eigenvalue, limit.analytic.value(), 1e-3 * limit.analytic.value()) << limit.name;
    EXPECT_NEAR(limit.simulation, limit.analytic.value(), 1e-2 * limit.analytic.value()) << limit.name;
  }
}

/// 4 - 2 lambda B dt / M - lambda K dt^2 / M
double margin(double K, double B, double M, double dt, double lambda) {
  return 4.0 - 2.0 * lambda * B * dt / M - lambda * K * dt * dt / M;
}

TEST(StabilityLimits, OfOneSpringDamperAreThoseOfA3) {
  const auto& limits = plain_limits();
  EXPECT_NEAR(limits.at(StabilityCase::stiffness_undamped).analytic.value(), 1.6e6, 1e-3);
  EXPECT_NEAR(limits.at(StabilityCase::damping_alone).analytic.value(), 400.0, 1e-9);
  EXPECT_NEAR(limits.at(StabilityCase::stiffness_damped).analytic.value(), 433731.0,
              1.0);  // M (2 (sqrt(1 + zeta^2) - zeta))^2 / dt^2
  EXPECT_NEAR(limits.at(StabilityCase::stiffness_damped).damping_at_limit, 291.6, 0.05);
  expect_three_ways_to_agree(limits);
}

TEST(StabilityLimits, SolveTheInequality) {
  for (const char* zeta : {"0", "3"}) {
    const Scenario scenario = single_spring({std::string("rendering.damping_ratio=") + zeta});
    const double M = 0.1, dt = 0.0005, given_K = 20000.0, z = std::stod(zeta);
    const auto limits = limits_of(scenario);
    const double K = limits.at(StabilityCase::stiffness_damped).analytic.value(),
                 step = limits.at(StabilityCase::time_step).analytic.value();
    EXPECT_NEAR(margin(K, 2.0 * z * std::sqrt(K * M), M, dt, 1.0), 0.0, 1e-12) << zeta;
    EXPECT_NEAR(margin(given_K, 2.0 * z * std::sqrt(given_K * M), M, step, 1.0), 0.0, 1e-12) << zeta;
    expect_three_ways_to_agree(limits);
    if (z == 0.0) {
      EXPECT_DOUBLE_EQ(K, limits.at(StabilityCase::stiffness_undamped).analytic.value());
    }
  }
}

TEST(StabilityLimits, WithAGivenDampingCoefficientUseIt) {
  const auto limits = limits_of(single_spring({"rendering.damping_N_s_per_m=100"}));
  // 4 - 2 * 100 * 0.005 = 3 is left for K dt^2 / M.
  EXPECT_NEAR(limits.at(StabilityCase::stiffness_damped).analytic.value(), 3.0 * 0.1 / 0.0005 / 0.0005, 1e-3);
  EXPECT_NEAR(margin(20000.0, 100.0, 0.1, limits.at(StabilityCase::time_step).analytic.value(), 1.0), 0.0, 1e-12);
  expect_three_ways_to_agree(limits);
}

TEST(StabilityLimits, OfSeveralSpringsAreDividedByLambda) {
  const struct {
    const char *groups, *algorithm;
    double lambda;
  } kCases[] = {
      {R"([{"direction":[1,0,0],"count":7},{"direction":[0,-1,0],"count":3}])", "summation", 7.0},
      // Three at 60 degrees: S = 3/2 I in the plane.
      {R"([{"direction":[1,0,0],"count":1},{"direction":[0.5,0.8660254037844386,0],"count":1},
           {"direction":[-0.5,0.8660254037844386,0],"count":1}])",
       "summation", 1.5},
      {R"([{"direction":[1,0,0],"count":10},{"direction":[-1,0,0],"count":10}])", "shaped_stiffness", 1.0},
      {R"([{"direction":[1,0,0],"count":4}])", "virtual_coupling", 0.8},  // in series: 1 / (1 + 1 / 4)
  };
  const auto& one = plain_limits();
  for (const auto& c : kCases) {
    SCOPED_TRACE(std::string(c.algorithm) + " " + c.groups);
    const auto limits = limits_of(single_spring(
        {std::string("environment.groups=") + c.groups, std::string("rendering.algorithm=") + c.algorithm}));
    for (const auto& [which, limit] : limits) {
      EXPECT_NEAR(limit.lambda, c.lambda, 1e-12);
      // K without damping and B scale as 1 / lambda; the damped ones follow from the inequality.
      if (which == StabilityCase::stiffness_undamped || which == StabilityCase::damping_alone) {
        EXPECT_NEAR(limit.analytic.value(), one.at(which).analytic.value() / c.lambda, 1e-9 * limit.analytic.value());
      } else if (which == StabilityCase::stiffness_damped) {
        EXPECT_NEAR(margin(limit.analytic.value(), limit.damping_at_limit, 0.1, 0.0005, c.lambda), 0.0, 1e-11);
      }
    }
    expect_three_ways_to_agree(limits);
  }
}

TEST(StabilityLimits, ThatDoNotExistAreInfinite) {
  for (const auto& [which, limit] : limits_of(single_spring({"environment.groups=[]"}))) {
    EXPECT_TRUE(std::isinf(limit.analytic.value())) << limit.name;
    EXPECT_TRUE(std::isinf(limit.eigenvalue)) << limit.name;
    EXPECT_TRUE(std::isinf(limit.simulation)) << limit.name << " " << limit.simulation;
  }
  const auto no_stiffness = limits_of(single_spring({"rendering.stiffness_N_per_m=0"}));
  EXPECT_TRUE(std::isinf(no_stiffness.at(StabilityCase::time_step).analytic.value()));
  EXPECT_TRUE(std::isinf(no_stiffness.at(StabilityCase::time_step).simulation));
  EXPECT_TRUE(std::isfinite(no_stiffness.at(StabilityCase::stiffness_undamped).simulation));
}

TEST(StabilityLimits, OfImplicitIntegratorsDoNotExist) {
  for (const auto& [integrator, zeta] : {std::pair{"implicit_euler", "0.7"}, {"implicit_midpoint", "0"}}) {
    for (const auto& [which, limit] : limits_of(single_spring(
             {std::string("integrator.type=") + integrator, std::string("rendering.damping_ratio=") + zeta}))) {
      SCOPED_TRACE(std::string(integrator) + " " + limit.name);
      EXPECT_TRUE(std::isinf(limit.analytic.value()));
      EXPECT_TRUE(std::isinf(limit.eigenvalue)) << limit.eigenvalue;
      EXPECT_TRUE(std::isinf(limit.simulation)) << limit.simulation;
    }
  }
}

TEST(StabilityLimits, OfExplicitIntegratorsAreTheirOwn) {
  const struct {
    const char* integrator;
    double spring, damper;  // of K dt^2 / M alone, of B dt / M alone
  } kCases[] = {{"velocity_verlet", 4.0, 4.0}, {"rk4", 8.0, 2.785293563405282}};
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.integrator);
    const std::string integrator = std::string("integrator.type=") + c.integrator;
    const auto limits = limits_of(single_spring({integrator}));
    EXPECT_NEAR(limits.at(StabilityCase::stiffness_undamped).analytic.value(), c.spring * 0.1 / 0.0005 / 0.0005, 1e-3);
    EXPECT_NEAR(limits.at(StabilityCase::damping_alone).analytic.value(), c.damper * 0.1 / 0.0005, 1e-9);
    // Spring and damper together: no closed form, least of all leapfrog's.
    EXPECT_FALSE(limits.at(StabilityCase::stiffness_damped).analytic);
    EXPECT_FALSE(limits.at(StabilityCase::time_step).analytic);
    for (const auto& [which, limit] : limits) {
      EXPECT_NEAR(limit.eigenvalue, limit.limit(), 1e-3 * limit.limit()) << limit.name;
      EXPECT_NEAR(limit.simulation, limit.limit(), 1e-2 * limit.limit()) << limit.name;
    }
    const auto undamped = limits_of(single_spring({integrator, "rendering.damping_ratio=0"}));
    expect_three_ways_to_agree(undamped);
    EXPECT_NEAR(undamped.at(StabilityCase::time_step).analytic.value(), std::sqrt(c.spring * 0.1 / 20000.0), 1e-15);
  }
}

TEST(StabilityLimits, DoNotDependOnHowTheScenarioWouldRun) {
  const auto& plain = plain_limits();
  const auto other = limits_of(single_spring({"initial.position_m=[0.5,0.1,0]", "time.steps=1",
                                              "bounds.position_m=1e-9", "record.every=3", "expect.outcome=diverges"}));
  for (const auto& [which, limit] : plain) EXPECT_EQ(other.at(which).simulation, limit.simulation) << limit.name;
}

TEST(StabilityLimits, AreRefusedWhereNoneExist) {
  const struct {
    const char *override, *place;
  } kCases[] = {
      {R"(environment={"type":"plane"})", "/environment/type"},
      {"environment.bilateral=false", "/environment/bilateral"},
      {"environment.signed=false", "/environment/signed"},
      {"rendering.friction.mu_s_N_s_per_m=1", "/rendering/friction"},
      {"rendering.friction.mu_f_s_per_m=1", "/rendering/friction"},
      {"rendering.limits.max_damping_N_s_per_m=1", "/rendering/limits/max_damping_N_s_per_m"},
      {"rendering.limits.max_force_N=1", "/rendering/limits/max_force_N"},
      {R"(hand={"type":"force","x_N":5})", "/hand/type"},
      {"rendering.passivity_controller=true", "/rendering/passivity_controller"},
      {R"(motion={"position":{"type":"prescribed","x_m":0,"y_m":0,"z_m":0}})", "/motion/position/type"},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.override);
    const Scenario scenario = single_spring({c.override});
    const auto error = test::input_error_of([&] { stability_limits(scenario); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->place(), c.place);
    EXPECT_EQ(error->kind(), InputError::Kind::relation);
  }
}

/// A tool that dry friction holds is a spring K in the normal and K_t along the surface: on one face the lesser of the
/// two limits of A.3, which both have a closed form; on two walls at right angles K + K_t / 4 along either.
TEST(StabilityLimits, OfAToolHeldByDryFrictionHaveItsBristle) {
  const auto stuck = [](const std::vector<std::string>& overrides) {
    std::optional<StabilityLimit> found;
    for (const StabilityLimit& limit : stability_limits(single_spring(overrides)))
      if (limit.stuck) found = limit;
    return found;
  };
  const auto a3 = [](double zeta) { return 0.1 * std::pow(2.0 * (std::sqrt(1.0 + zeta * zeta) - zeta) / 0.0005, 2); };
  const auto expect = [](const std::optional<StabilityLimit>& limit, double known) {
    ASSERT_TRUE(limit);
    EXPECT_NEAR(limit->eigenvalue, known, 1e-6 * known);
    EXPECT_NEAR(limit->simulation, known, 1e-2 * known);
  };
  EXPECT_FALSE(stuck({}));
  // K_t = K follows K.
  expect(stuck({R"(rendering.friction={"type":"dry","mu":0.3})"}), a3(1.0));
  expect(stuck({R"(rendering.friction={"type":"dry","mu":0.3,"damping_ratio":0.2})"}), a3(0.7));
  expect(stuck({R"(rendering.friction={"type":"dry","mu":0.3,"stiffness_N_per_m":1000})"}), a3(0.7));
  const std::string walls = R"(environment.groups=[{"direction":[1,0,0],"count":1},{"direction":[0,1,0],"count":1}])";
  // Undamped: K (1 + 1/4) dt^2 / M = 4 along the walls' normals, K along the line.
  expect(stuck({walls, "rendering.algorithm=summation", "rendering.damping_ratio=0",
                R"(rendering.friction={"type":"dry","mu":0.3,"damping_ratio":0})"}),
         1.6e6 / 1.25);
  // Springs that face each other cannot both press.
  EXPECT_FALSE(stuck({R"(environment.groups=[{"direction":[1,0,0],"count":1},{"direction":[-1,0,0],"count":1}])",
                      R"(rendering.friction={"type":"dry","mu":0.3})"}));
}

TEST(RootLocus, LeavesTheUnitCircleAtTheLimit) {
  const Scenario scenario = single_spring();
  const auto limits = stability_limits(scenario);
  std::map<StabilityCase, std::size_t> points;
  for (const RootLocusPoint& point : root_locus(scenario, limits)) {
    ++points[point.which];
    const double limit = limits[static_cast<std::size_t>(point.which)].analytic.value();
    ASSERT_EQ(limits[static_cast<std::size_t>(point.which)].which, point.which);
    EXPECT_LE(point.value, 1.25 * limit * (1.0 + 1e-12));
    const double radius = std::max(std::abs(point.first), std::abs(point.second));
    // The double eigenvalue 1 at value 0 is known to the root of rounding only.
    if (point.value < limit * (1.0 - 1e-9)) {
      EXPECT_LE(radius, 1.0 + 1e-7);
    } else if (point.value > limit * (1.0 + 1e-9)) {
      EXPECT_GT(radius, 1.0);
    }
  }
  EXPECT_EQ(points.size(), 4u);
  for (const auto& [which, n] : points) EXPECT_GE(n, 400u);
}

TEST(RootLocus, OmitsLimitsThatDoNotExist) {
  const Scenario scenario = single_spring({"environment.groups=[]"});
  EXPECT_TRUE(root_locus(scenario, stability_limits(scenario)).empty());
}

/// Keeps the places of tool and handle along x, row by row.
class Places final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    tool.push_back(record.tool.pose.position.x());
    handle.push_back(record.handle.position.x());
    handle_velocity.push_back(record.handle.velocity.x());
  }
  std::vector<double> tool, handle, handle_velocity;
};

Places places_of(const Scenario& scenario) {
  Places places;
  Simulation(simulation_config(scenario), assemble(scenario), {&places}).run();
  return places;
}

Scenario struck(Scenario scenario) {
  scenario.time.steps = 60;
  scenario.initial.velocity.x() = 0.02;
  return scenario;
}

Scenario wall_on_handle(double delay, double K) {
  const std::vector<std::string> overrides = {fmt::format("device.delay_samples={}", delay),
                                              fmt::format("rendering.stiffness_N_per_m={}", K)};
  return struck(load_scenario(find_scenario("wall_on_handle"), overrides).scenario);
}

/// A hand on the admittance device, on a wall from both sides.
Scenario admittance_on_wall(double delay) {
  Scenario scenario = load_scenario(find_scenario("single_spring"), {}).scenario;
  ImpedanceHandFields hand;
  hand.stiffness = 2000.0;
  scenario.hand = hand;
  AdmittanceDeviceConfig device;
  device.servo.delay = static_cast<std::size_t>(delay);
  scenario.device = device;
  return struck(scenario);
}

/// Some sixty steps of rounding, of a state that need not decay.
constexpr double kRounding = 1e-12;

void expect_same_motion(const Scenario& scenario) {
  const Eigen::MatrixXd A = device_loop(scenario, 1.0).state_matrix();
  const double T = scenario.time.step, x = scenario.initial.position.x();
  Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
  state.head(3) << x, T * scenario.initial.velocity.x(), x;  // and the filter at rest
  const Places places = places_of(scenario);
  double scale = state.norm();
  for (std::size_t k = 0; k < places.tool.size(); ++k) {
    scale = std::max(scale, state.norm());
    ASSERT_NEAR(places.tool[k], state[0], kRounding * scale) << k;
    ASSERT_NEAR(places.handle[k], state[0], kRounding * scale) << k;
    ASSERT_NEAR(places.handle_velocity[k] * T, state[1], kRounding * scale) << k;
    state = A * state;
  }
}

TEST(DeviceLoop, OfAnImpedanceDeviceIsTheSimulationsLinearMap) {
  Random random(1);
  for (const double delay : {0.0, 0.25, 1.0, 2.5}) {
    for (const bool filtered : {false, true}) {
      for (const bool held : {false, true}) {
        Scenario scenario = wall_on_handle(delay, 5000.0 * random.uniform());
        auto& device = std::get<ImpedanceDeviceConfig>(scenario.device);
        device.viscous = random.uniform();
        device.handle_mass = 0.05 + random.uniform();
        if (filtered) device.velocity_filter = LowPassFilter{200.0 * random.uniform()};
        if (held) {
          MassSpringDamperHandFields hand;
          hand.mass = random.uniform();
          hand.spring = {1000.0 * random.uniform(), 10.0 * random.uniform(), {}, {}};
          scenario.hand = hand;
        }
        SCOPED_TRACE(testing::Message() << delay << " " << filtered << " " << held);
        expect_same_motion(scenario);
      }
    }
  }
}

TEST(DeviceLoop, OfTheAdmittanceDeviceIsTheSimulationsLinearMap) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double delay : {0.0, 1.0, 3.0}) {
      Scenario scenario = admittance_on_wall(delay);
      auto& device = std::get<AdmittanceDeviceConfig>(scenario.device);
      device.force_limit.reset();
      device.servo.max_force = 1e9;
      scenario.integrator.type = integrator;
      scenario.initial.position.x() = 1e-3;
      const Eigen::MatrixXd A = device_loop(scenario, 1.0).state_matrix();
      const double x = 1e-3, Tv = scenario.time.step * 0.02;
      Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
      state.head(6) << x, Tv, x, Tv, x, Tv;
      const Places places = places_of(scenario);
      double scale = state.norm();
      for (std::size_t k = 0; k < places.tool.size(); ++k) {
        scale = std::max(scale, state.norm());
        ASSERT_NEAR(places.tool[k], state[0], kRounding * scale) << integrator->info.name << " " << k;
        ASSERT_NEAR(places.handle[k], state[4], kRounding * scale) << integrator->info.name << " " << k;
        state = A * state;
      }
    }
  }
}

TEST(DeviceLoop, SaysWhatIsNotLinear) {
  const Scenario linear = wall_on_handle(0.0, 1000.0);
  EXPECT_EQ(device_loop(linear, 1.0).no_theory, "");
  Scenario scenario = linear;
  std::get<ImpedanceDeviceConfig>(scenario.device).velocity_filter = AdaptiveWindowFilter{};
  EXPECT_NE(device_loop(scenario, 1.0).no_theory, "");
  scenario = linear;
  scenario.hand = ImpedanceHandFields{};
  EXPECT_NE(device_loop(scenario, 1.0).no_theory, "") << "held between samples";
  Scenario dry = linear;
  std::get<ImpedanceDeviceConfig>(dry.device).coulomb = 0.02;
  EXPECT_NE(device_loop(dry, 1.0).no_theory, "");
}

TEST(DeviceLoop, KnowsEveryFieldOfTheDevices) {
  Scenario scenario;
  const LowPassFilter filter{50.0, 3};
  for (const VelocityFilterConfig& velocity :
       {VelocityFilterConfig(filter), VelocityFilterConfig(AdaptiveWindowFilter{2e-5})}) {
    scenario.device = ImpedanceDeviceConfig{
        0.1, 0.2, 0.3, 1e-5, 1.5, velocity, 5.0, 0.01, 100.0, filter, 1e-6, 9, Transmission{0.3, 2000.0, 2.0}};
    EXPECT_EQ(unknown_to_theory(scenario), "");
  }
  scenario.device = AdmittanceDeviceConfig{
      {1.0, Vec3::UnitX(), false, 0.1, 7}, 3.0, {1e4, 100.0, 20.0, 3}, {1.0, 2.0, 3.0, 4.0, 5.0}};
  EXPECT_EQ(unknown_to_theory(scenario), "");
}

TEST(DeviceLoop, HasTheWallOfTheSpringsInIt) {
  const SampledLoop loop = std::get<SampledLoop>(device_loop(wall_on_handle(0.0, 1000.0), 0.5).loop);
  EXPECT_EQ(loop.stiffness, 500.0);
  EXPECT_EQ(loop.wall_damping, 2.5);
}

}  // namespace
}  // namespace hapbench::stability_limits_test
