#include "scenarios/studies/stability/stability_limits.hpp"

#include <gtest/gtest.h>

#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/stability_map.hpp"
#include "sim/core/random.hpp"

/// The linear loops against the simulation that scenarios are run by.
namespace hapbench::device_loop_test {
namespace {

/// Where tool and handle were along x, row by row.
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

Scenario scene_of(const char* map, double x, double y) {
  Scenario scenario = find_stability_map(map)->scene(x, y, "summation");
  scenario.time.steps = 60;
  scenario.initial.velocity.x() = 0.02;
  return scenario;
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
        Scenario scenario = scene_of("delay", delay, 5000.0 * random.uniform());
        auto& device = std::get<ImpedanceDeviceConfig>(scenario.device);
        device.viscous = random.uniform();
        device.handle_mass = 0.05 + random.uniform();
        if (filtered) device.velocity_filter = LowPassFilter{200.0 * random.uniform()};
        if (held) {
          MassSpringDamperHandFields hand;
          hand.mass = random.uniform();
          hand.spring = {1000.0 * random.uniform(), 10.0 * random.uniform(), {}};
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
      Scenario scenario = scene_of("device", delay, 2000.0);
      std::get<SpringsEnvironment>(scenario.environment).bilateral = true;
      std::get<ImpedanceHandFields>(scenario.hand).target = {};
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
  const Scenario linear = scene_of("z_width", 5.0, 1000.0);
  EXPECT_EQ(device_loop(linear, 1.0).no_theory, "");
  Scenario scenario = linear;
  std::get<ImpedanceDeviceConfig>(scenario.device).velocity_filter = AdaptiveWindowFilter{};
  EXPECT_NE(device_loop(scenario, 1.0).no_theory, "");
  scenario = linear;
  scenario.hand = ImpedanceHandFields{};
  EXPECT_NE(device_loop(scenario, 1.0).no_theory, "") << "held between samples";
  EXPECT_NE(device_loop(scene_of("encoder_step", 1e-5, 1000.0), 1.0).no_theory, "");
}

TEST(DeviceLoop, HasTheWallOfTheSpringsInIt) {
  const SampledLoop loop = std::get<SampledLoop>(device_loop(scene_of("z_width", 5.0, 1000.0), 0.5).loop);
  EXPECT_EQ(loop.stiffness, 500.0);
  EXPECT_EQ(loop.wall_damping, 2.5);
}

}  // namespace
}  // namespace hapbench::device_loop_test
