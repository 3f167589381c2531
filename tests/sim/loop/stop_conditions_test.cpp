#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/loop/simulation.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::stop_conditions_test {
namespace {

using test::fake_parts;
using test::Recorder;

const Vec3 kUp(0, 0, 1);

/// A weightless tool that rises at 1 m/s along `up` from 10.5 steps below height 0.
SimulationConfig rising(const Vec3& up) {
  SimulationConfig config;
  config.steps = 100;
  config.velocity = up;
  config.position = -10.5 * config.dt * up;
  return config;
}

TEST(StopConditions, LeavesTheHoleAtTheFirstRowAboveHeightZeroWhichIsRecorded) {
  for (const Vec3& up : {Vec3(0, 0, 1), Vec3(0, 1, 0)}) {
    SimulationConfig config = rising(up);
    config.stop_when = {when_tool_leaves_hole(up)};
    Recorder recorder;
    const SimulationResult result = Simulation(config, fake_parts(test::weightless), {&recorder}).run();
    EXPECT_EQ(result.outcome, Outcome::leaves_hole);
    // Row 11 is half a step above.
    EXPECT_EQ(result.rows, 12u);
    ASSERT_EQ(recorder.rows.size(), 12u);
    EXPECT_GT(recorder.rows[11].tool.pose.position.dot(up), 0.0);
    EXPECT_LT(recorder.rows[10].tool.pose.position.dot(up), 0.0);
  }
}

TEST(StopConditions, ExactlyAtHeightZeroTheToolIsStillInTheHole) {
  SimulationConfig config;
  config.steps = 3;
  config.stop_when = {when_tool_leaves_hole(kUp)};
  Recorder recorder;
  EXPECT_EQ(Simulation(config, fake_parts(test::weightless), {&recorder}).run().outcome, Outcome::completes);
}

TEST(StopConditions, AreOffByDefault) {
  Recorder recorder;
  EXPECT_EQ(Simulation(rising(kUp), fake_parts(test::weightless), {&recorder}).run().outcome, Outcome::completes);
  EXPECT_EQ(recorder.rows.size(), 100u);
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

TEST(StopConditions, HorizontalIsIgnoredUnlessAskedFor) {
  SimulationConfig config;
  config.steps = 10;
  Recorder recorder;
  EXPECT_EQ(Simulation(config, tilting(kUp, 2.0, 0.0), {&recorder}).run().outcome, Outcome::completes);
}

TEST(StopConditions, TheEarlierOneWins) {
  SimulationConfig config = rising(kUp);
  config.stop_when = {when_tool_leaves_hole(kUp), when_tool_is_horizontal(kUp)};
  Recorder recorder;
  EXPECT_EQ(Simulation(config, tilting(kUp, 0.1, 0.0), {&recorder}).run().outcome, Outcome::leaves_hole);
  EXPECT_EQ(Simulation(config, tilting(kUp, 2.0, 0.0), {&recorder}).run().outcome, Outcome::tool_horizontal);
}

TEST(StopConditions, AStopOnTheLastRowIsStillAStop) {
  SimulationConfig config = rising(kUp);
  config.stop_when = {when_tool_leaves_hole(kUp)};
  config.steps = 12;
  Recorder recorder;
  EXPECT_EQ(Simulation(config, fake_parts(test::weightless), {&recorder}).run().outcome, Outcome::leaves_hole);
}

TEST(StopConditions, AStoppedRunTakesNoFurtherSteps) {
  SimulationConfig config = rising(kUp);
  config.stop_when = {when_tool_leaves_hole(kUp)};
  Recorder recorder;
  Simulation simulation(config, fake_parts(test::weightless), {&recorder});
  simulation.run();
  const Vec3 position = simulation.tool().pose.position;
  EXPECT_FALSE(simulation.step());
  EXPECT_EQ(simulation.tool().pose.position, position);
  EXPECT_EQ(recorder.rows.size(), 12u);
}

}  // namespace
}  // namespace hapbench::stop_conditions_test
