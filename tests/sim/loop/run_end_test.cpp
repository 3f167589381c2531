#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sim/loop/simulation.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::run_end_test {
namespace {

using test::fake_parts;
using test::Recorder;

/// A weightless tool that rises at 1 m/s along `up` from 10.5 steps below height 0.
SimulationConfig rising(const Vec3& up) {
  SimulationConfig config;
  config.steps = 100;
  config.velocity = up;
  config.position = -10.5 * config.dt * up;
  return config;
}

SimulationResult run(const SimulationConfig& config, SimulationParts parts, Recorder& recorder) {
  return Simulation(config, std::move(parts), {&recorder}).run();
}

TEST(StopConditions, LeavesTheHoleAtTheFirstRowAboveHeightZeroWhichIsRecorded) {
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 1, 0)}) {
    SimulationConfig config = rising(up);
    config.stop_when = {when_tool_leaves_hole(up)};
    // Row 11 is half a step above; a stop on the last row is still a stop.
    for (const std::uint64_t steps : {100u, 12u}) {
      config.steps = steps;
      Recorder recorder;
      const SimulationResult result = run(config, fake_parts(test::weightless), recorder);
      EXPECT_EQ(result.outcome, Outcome::leaves_hole);
      EXPECT_EQ(result.rows, 12u);
      ASSERT_EQ(recorder.rows.size(), 12u);
      EXPECT_GT(recorder.rows[11].tool.pose.position.dot(up), 0.0);
      EXPECT_LT(recorder.rows[10].tool.pose.position.dot(up), 0.0);
    }
  }
}

SimulationParts tilting(const Vec3& up, double start, double rate_per_s) {
  SimulationParts parts = fake_parts(test::weightless);
  parts.motion = std::make_unique<ScriptedMotion>(
      Orientation{up, {1, 0, 0}, Profile::Shape(Profile::Ramp{start, rate_per_s}), {}}, std::nullopt);
  return parts;
}

TEST(StopConditions, ToolIsHorizontalAtTheFirstRowWhereItsAxisReachesThePlaneWhichIsRecorded) {
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 1, 0)}) {
    SimulationConfig config;
    config.steps = 10000;
    config.stop_when = {when_tool_is_horizontal(up)};
    Recorder recorder;
    const SimulationResult result = Simulation(config, tilting(up, 0.1, 1.2), {&recorder}).run();
    EXPECT_EQ(result.outcome, Outcome::tool_horizontal);
    // 0.1 + 1.2 k dt = pi / 2.
    const double k = std::ceil((std::numbers::pi / 2 - 0.1) / 1.2 / config.dt);
    EXPECT_EQ(static_cast<double>(result.rows), k + 1);
    ASSERT_EQ(recorder.rows.size(), result.rows);
    EXPECT_GE(recorder.rows.back().tool.pose.axis.dot(up), 0.0);
    EXPECT_LT(recorder.rows[recorder.rows.size() - 2].tool.pose.axis.dot(up), 0.0);
  }
}

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
  const struct {
    Vec3 velocity;
    double force;
    const char* quantity;
    std::uint64_t step;
    double magnitude, bound;
  } kCases[] = {{{0, 0, 3}, 0.0, "position", 2, 0.75, 0.5},  // 0.375 m a step
                {{0, 0, 5}, 0.0, "velocity", 0, 5.0, 4.0},
                {{0, 0, 0}, 17.0, "rendered force", 0, 17.0, 16.0}};
  for (const auto& c : kCases) {
    SimulationConfig config = config_of(100);
    config.bounds = {0.5, 4.0, 16.0};
    config.dt = 0.125;
    config.velocity = c.velocity;
    Recorder recorder;
    const SimulationResult result = run(config, fake_parts(after(0, {0, 0, c.force})), recorder);
    EXPECT_EQ(recorder.rows.size(), result.rows);
    EXPECT_EQ(result.rows, c.step);
    EXPECT_EQ(result.divergence.step, c.step);
    EXPECT_EQ(result.divergence.quantity, std::string(c.quantity));
    EXPECT_EQ(result.divergence.magnitude, c.magnitude);
    EXPECT_EQ(result.divergence.bound, c.bound);
  }
}

}  // namespace
}  // namespace hapbench::run_end_test
