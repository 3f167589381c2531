#include <gtest/gtest.h>

#include "tests/support/fakes.hpp"

namespace hapbench::prescribed_motion_test {
namespace {

using test::fake_parts;
using test::Recorder;

std::array<Profile, 3> some_path() {
  return {Profile::Shape(Profile::Sine{0.001, 0.002, 0.1, 0.3}), Profile::Shape(Profile::Ramp{0.5, -2.0}), 0.25};
}

std::vector<StepRecord> run_along(std::array<Profile, 3> path, test::FakeAlgorithm::Law law) {
  SimulationParts parts = fake_parts(std::move(law));
  parts.motion = std::make_unique<ScriptedMotion>(Orientation{}, std::move(path));
  SimulationConfig config;
  config.steps = 200;
  config.position = {7, 7, 7};
  config.velocity = {3, 3, 3};
  Recorder recorder;
  Simulation simulation(config, std::move(parts), {&recorder});
  simulation.run();
  // The second run of the same object must not remember the first.
  simulation.reset();
  recorder.rows.clear();
  simulation.run();
  return recorder.rows;
}

TEST(PrescribedMotion, PutsTheToolWhereTheScriptSays) {
  const auto path = some_path();
  const auto rows = run_along(path, test::weightless);
  ASSERT_EQ(rows.size(), 200u);
  for (const StepRecord& row : rows) {
    EXPECT_EQ(row.tool.pose.position, Vec3(path[0](row.time), path[1](row.time), path[2](row.time)));
  }
}

TEST(PrescribedMotion, VelocityIsTheBackwardDifferenceAndZeroInRowZero) {
  const auto rows = run_along(some_path(), test::weightless);
  EXPECT_EQ(rows[0].tool.velocity, Vec3(0, 0, 0));
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const Vec3 moved = rows[k].tool.pose.position - rows[k - 1].tool.pose.position;
    EXPECT_EQ(rows[k].tool.velocity, Vec3(moved / SimulationConfig{}.dt));
  }
}

TEST(PrescribedMotion, ForcesAreComputedButDoNotMoveTheTool) {
  const auto free = run_along(some_path(), test::weightless);
  const auto pushed = run_along(some_path(), [](const ToolState&) { return Vec3(1e6, -1e6, 1e6); });
  for (std::size_t k = 0; k < free.size(); ++k) {
    EXPECT_EQ(pushed[k].force.rendered, Vec3(1e6, -1e6, 1e6));
    EXPECT_EQ(pushed[k].tool.pose.position, free[k].tool.pose.position);
    EXPECT_EQ(pushed[k].tool.velocity, free[k].tool.velocity);
  }
}

TEST(PrescribedMotion, TheHandleOfAnIdealDeviceFollows) {
  for (const StepRecord& row : run_along(some_path(), test::weightless)) {
    EXPECT_EQ(row.handle.position, row.tool.pose.position);
    EXPECT_EQ(row.handle.velocity, row.tool.velocity);
  }
}

}  // namespace
}  // namespace hapbench::prescribed_motion_test
