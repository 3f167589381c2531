#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/support/fakes.hpp"

namespace hapbench::divergence_test {
namespace {

using test::fake_parts;
using test::Recorder;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

SimulationConfig config_of(std::uint64_t steps) {
  SimulationConfig config;
  config.steps = steps;
  return config;
}

/// No force before the tool has been asked `steps` times, then the given one.
test::FakeAlgorithm::Law after(int steps, const Vec3& force) {
  return [=, k = 0](const ToolState&) mutable { return k++ < steps ? Vec3(Vec3::Zero()) : force; };
}

TEST(Divergence, StopsAtTheRowWhoseForceIsNotFiniteAndKeepsTheRowsBefore) {
  for (const double bad : {kNaN, kInf, -kInf}) {
    Recorder recorder;
    Simulation simulation(config_of(100), fake_parts(after(5, {0, bad, 0})), {&recorder});
    const SimulationResult result = simulation.run();
    EXPECT_EQ(result.outcome, Outcome::diverges);
    EXPECT_EQ(result.rows, 5u);
    ASSERT_EQ(recorder.rows.size(), 5u);
    for (const StepRecord& row : recorder.rows) EXPECT_TRUE(row.force.rendered.allFinite());
    EXPECT_EQ(result.divergence.step, 5u);
    EXPECT_EQ(result.divergence.time, 5 * SimulationConfig{}.dt);
    EXPECT_EQ(result.divergence.quantity, std::string("rendered force"));
    EXPECT_FALSE(std::isfinite(result.divergence.magnitude));
    EXPECT_EQ(result.divergence.bound, DivergenceBounds{}.force);
    EXPECT_FALSE(simulation.step());
  }
}

TEST(Divergence, IsReportedForEachQuantityThatLeavesItsBound) {
  SimulationConfig config = config_of(100);
  config.bounds = {0.5, 4.0, 16.0};
  const auto result_of = [](const SimulationConfig& c, const test::FakeAlgorithm::Law& law) {
    Recorder recorder;
    const SimulationResult result = Simulation(c, fake_parts(law), {&recorder}).run();
    EXPECT_EQ(recorder.rows.size(), result.rows);
    EXPECT_EQ(result.divergence.step, result.rows);
    return result;
  };

  config.velocity = {0, 0, 3.0};
  config.dt = 0.125;  // 0.375 m a step
  SimulationResult result = result_of(config, test::weightless);
  EXPECT_EQ(result.divergence.quantity, std::string("position"));
  EXPECT_EQ(result.divergence.step, 2u);
  EXPECT_EQ(result.divergence.magnitude, 0.75);
  EXPECT_EQ(result.divergence.bound, 0.5);

  config.velocity = {0, 0, 5.0};
  result = result_of(config, test::weightless);
  EXPECT_EQ(result.divergence.quantity, std::string("velocity"));
  EXPECT_EQ(result.divergence.step, 0u);
  EXPECT_EQ(result.divergence.magnitude, 5.0);
  EXPECT_EQ(result.divergence.bound, 4.0);

  config.velocity = Vec3::Zero();
  result = result_of(config, after(0, {0, 0, 17.0}));
  EXPECT_EQ(result.divergence.quantity, std::string("rendered force"));
  EXPECT_EQ(result.divergence.magnitude, 17.0);
  EXPECT_EQ(result.divergence.bound, 16.0);
}

TEST(Divergence, ABoundItselfIsStillWithin) {
  SimulationConfig config = config_of(1);
  config.bounds = {0.5, 4.0, 16.0};
  config.position = {0.5, 0, 0};
  config.velocity = {0, 4.0, 0};
  EXPECT_EQ(Simulation(config, fake_parts(after(0, {16.0, 0, 0})), {}).run().outcome, Outcome::completes);
}

TEST(Divergence, ANonFinitePositionOrVelocityIsFoundAtItsRow) {
  for (const double bad : {kNaN, kInf}) {
    SimulationConfig config = config_of(10);
    config.position = {bad, 0, 0};
    EXPECT_EQ(Simulation(config, fake_parts(test::weightless), {}).run().divergence.quantity, std::string("position"));
    config = config_of(10);
    config.velocity = {0, bad, 0};
    EXPECT_EQ(Simulation(config, fake_parts(test::weightless), {}).run().divergence.quantity, std::string("velocity"));
  }
}

TEST(Divergence, OfAPrescribedPositionIsFoundToo) {
  SimulationParts parts = fake_parts(test::weightless);
  parts.motion = std::make_unique<ScriptedMotion>(
      Orientation{}, std::array<Profile, 3>{Profile::Shape(Profile::Ramp{0.0, 1e6}), 0.0, 0.0});
  Recorder recorder;
  const SimulationResult result = Simulation(config_of(10), std::move(parts), {&recorder}).run();
  EXPECT_EQ(result.outcome, Outcome::diverges);
  // 500 m a step: row 3 is beyond 1 km.
  EXPECT_EQ(result.rows, 3u);
}

TEST(Divergence, IsForgottenByReset) {
  SimulationConfig config = config_of(10);
  int rows = 0;
  Simulation simulation(config, fake_parts([&rows](const ToolState&) { return Vec3(0, 0, rows++ == 3 ? kNaN : 0.0); }),
                        {});
  EXPECT_EQ(simulation.run().outcome, Outcome::diverges);
  simulation.reset();
  EXPECT_EQ(simulation.run().outcome, Outcome::completes);
  EXPECT_EQ(simulation.result().rows, 10u);
}

TEST(Divergence, OfAnUnstableSpringComesFromTheIntegratorAlone) {
  // 10 times the stability limit 4 M/dt^2: the displacement multiplies by about 38 a step.
  SimulationConfig config = config_of(1000);
  config.position = {0.001, 0, 0};
  const double K = 40 * config.mass / (config.dt * config.dt);
  Recorder recorder;
  const auto result =
      Simulation(config, fake_parts([K](const ToolState& tool) { return Vec3(-K * tool.pose.position); }), {&recorder})
          .run();
  EXPECT_EQ(result.outcome, Outcome::diverges);
  EXPECT_LT(result.rows, 10u);
  EXPECT_EQ(recorder.rows.size(), result.rows);
}

}  // namespace
}  // namespace hapbench::divergence_test
