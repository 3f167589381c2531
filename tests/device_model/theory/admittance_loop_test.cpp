#include "device_model/theory/admittance_loop.hpp"

#include <gtest/gtest.h>

#include "device_model/admittance_device.hpp"
#include "device_model/hands/impedance_hand.hpp"
#include "device_model/theory/eigenvalue_edge.hpp"
#include "sim/core/random.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::admittance_loop_test {
namespace {

AdmittanceLoop random_loop(Random& random) {
  AdmittanceLoop loop;
  loop.tool.K = 40000.0 * random.uniform();
  loop.tool.B = 100.0 * random.uniform();
  loop.tool.M = 0.05 + 0.2 * random.uniform();
  loop.mechanics.handle_mass = 0.05 + 0.1 * random.uniform();
  loop.mechanics.structure_stiffness = 1e5 * (1.0 + random.uniform());
  loop.servo.delay = static_cast<std::size_t>(4.0 * random.uniform());
  loop.servo.max_force = 1e9;
  loop.hand_stiffness = 1000.0 * random.uniform();
  loop.hand_damping = 10.0 * random.uniform();
  return loop;
}

/// The rows of the simulation itself, from a random place and velocity of the tool.
std::vector<StepRecord> simulated(const AdmittanceLoop& loop, double position, double velocity, std::uint64_t steps) {
  test::Recorder recorder;
  SimulationConfig config;
  config.dt = loop.tool.dt;
  config.mass = loop.tool.M;
  config.integrator = loop.tool.integrator;
  config.steps = steps;
  config.position = position * Vec3::UnitX();
  config.velocity = velocity * Vec3::UnitX();
  SimulationParts parts = test::fake_parts([&loop](const ToolState& tool) -> Vec3 {
    return -loop.tool.K * tool.pose.position - loop.tool.B * tool.velocity;
  });
  parts.hand = std::make_unique<ImpedanceHand>(loop.hand_stiffness, loop.hand_damping, std::array<Profile, 3>{});
  AdmittanceDeviceConfig device;
  device.force_limit.reset();
  device.servo = loop.servo;
  device.mechanics = loop.mechanics;
  parts.device = std::make_unique<AdmittanceDevice>(device);
  Simulation(config, std::move(parts), {&recorder}).run();
  return recorder.rows;
}

/// The state that the matrix maps, of a run just begun: handle and carriage on the tool, no command on its way.
Eigen::VectorXd first_state(const AdmittanceLoop& loop, double position, double velocity) {
  Eigen::VectorXd state = Eigen::VectorXd::Zero(loop.state_matrix().rows());
  for (const Eigen::Index i : {0, 2, 4}) {
    state[i] = position;
    state[i + 1] = velocity * loop.tool.dt;
  }
  return state;
}

TEST(AdmittanceLoop, IsTheLinearMapOfTheSimulation) {
  Random random(1);
  for (const IntegratorEntry* integrator : {&kLeapfrog, &kVelocityVerlet, &kRk4}) {
    for (int i = 0; i < 10; ++i) {
      AdmittanceLoop loop = random_loop(random);
      loop.tool.integrator = integrator;
      const double position = 1e-3 * random.normal(), velocity = 0.1 * random.normal();
      const Eigen::MatrixXd A = loop.state_matrix();
      Eigen::VectorXd state = first_state(loop, position, velocity);
      double scale = state.norm();
      for (const StepRecord& row : simulated(loop, position, velocity, 40)) {
        scale = std::max(scale, state.norm());
        const double dt = loop.tool.dt;
        // Some forty steps of rounding, of a state that need not decay.
        EXPECT_NEAR(row.tool.pose.position.x(), state[0], 1e-12 * scale) << row.step;
        EXPECT_NEAR(row.tool.velocity.x() * dt, state[1], 1e-12 * scale) << row.step;
        EXPECT_NEAR(row.handle.position.x(), state[4], 1e-12 * scale) << row.step;
        EXPECT_NEAR(row.handle.velocity.x() * dt, state[5], 1e-12 * scale) << row.step;
        state = A * state;
      }
    }
  }
}

/// The stiffest hand that the loop bears, against runs a hundredth softer and stiffer.
TEST(AdmittanceLoop, HasItsEdgeWhereRunsGrow) {
  for (const std::size_t delay : {0u, 1u, 2u}) {
    AdmittanceLoop loop;
    loop.tool.K = 20000.0;
    loop.tool.B = 2.0 * 0.7 * std::sqrt(loop.tool.K * loop.tool.M);
    loop.servo.delay = delay;
    loop.servo.max_force = 1e9;
    loop.hand_damping = 6.0;
    const double edge = first_edge(1.0, 1e9, [loop](double k) mutable {
      loop.hand_stiffness = k;
      return loop.state_matrix();
    });
    ASSERT_GT(edge, 1.0);
    ASSERT_LT(edge, 1e8);
    const auto grows = [&](double factor) {
      loop.hand_stiffness = factor * edge;
      const auto rows = simulated(loop, 1e-6, 0.0, 20000);
      const auto largest = [&](std::size_t from) {
        double most = 0.0;
        for (std::size_t i = from; i < from + 2000; ++i) most = std::max(most, std::abs(rows[i].handle.velocity.x()));
        return most;
      };
      return rows.size() < 20000 || largest(18000) > largest(8000);
    };
    EXPECT_FALSE(grows(0.99)) << delay;
    EXPECT_TRUE(grows(1.01)) << delay;
  }
}

}  // namespace
}  // namespace hapbench::admittance_loop_test
