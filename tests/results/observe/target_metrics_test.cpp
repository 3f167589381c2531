#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/target_metrics.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/simulation.hpp"
#include "tests/results/observing.hpp"

namespace hapbench::target_metrics_test {
namespace {

const BlockWithHole kBlock;
constexpr double kRadius = 0.0005;

TEST(IdealPose, ExistsWhileTheTipIsOnTheWallAboveTheBottom) {
  const double limit = std::numbers::pi / 3;
  EXPECT_TRUE(ideal_tip_position(kBlock, kRadius, limit - 1e-9));
  EXPECT_FALSE(ideal_tip_position(kBlock, kRadius, limit + 1e-9));
  EXPECT_FALSE(ideal_tip_position(kBlock, kRadius, 0.0));
  EXPECT_FALSE(ideal_tip_position(kBlock, kRadius, -0.5));
  EXPECT_FALSE(ideal_tip_position(kBlock, kRadius, 0.01)) << "would be 100 mm deep";
  EXPECT_TRUE(ideal_tip_position(kBlock, kRadius, 0.3));
}

ToolPose tilted(const Vec3& position, double tilt, double azimuth = 0.0) {
  const Vec3 lean{std::cos(azimuth), std::sin(azimuth), 0.0};
  return {position, -(std::cos(tilt) * Vec3::UnitZ() + std::sin(tilt) * lean)};
}

TEST(IdealTrajectory, ComparesEachSoManyRows) {
  IdealTrajectoryObserver observer(kBlock, {}, 3);
  for (std::uint64_t step = 0; step < 8; ++step) {
    StepRecord record;
    record.step = step;
    record.tool.pose = tilted({0, 0, -0.001}, step == 3 ? 1.2 : 0.6);
    observer.on_step(record);
    EXPECT_EQ(observer.error().has_value(), step == 0 || step == 6) << step;
  }
  EXPECT_EQ(reported(observer, "gentle.rows"), 2.0) << "0 and 6";
  EXPECT_EQ(reported(observer, "rows_without_ideal"), 1.0) << "row 3";
}

constexpr double kRounding = 1e-11;  // error that the header states
const Cylinder kTool;

/// Returns the depth in the block [m] of a point on the lateral surface of the tool. `angle` is the angle of the point
/// about the tool's axis [rad], `height` its distance from the tip along the axis [m].
double depth_at(const ToolPose& pose, double angle, double height) {
  const Vec3 e1 = pose.axis.unitOrthogonal(), e2 = pose.axis.cross(e1);
  const Vec3 side = kTool.radius() * (std::cos(angle) * e1 + std::sin(angle) * e2);
  return -signed_distance(kBlock, pose.position + side - height * pose.axis);
}

/// Returns the largest depth [m] of the points at this angle about the tool's axis: evaluates many heights, then
/// searches around the deepest height by ternary search.
double deepest_at(const ToolPose& pose, double angle) {
  constexpr int kHeights = 400;
  // Spacing of the heights [m]. More than 6 mm above its tip, the tool is always in free air.
  constexpr double kSpacing = 0.006 / kHeights;
  double best = 0.0;
  for (int h = 0; h < kHeights; ++h) {
    if (depth_at(pose, angle, h * kSpacing) > depth_at(pose, angle, best)) best = h * kSpacing;
  }
  double low = std::max(0.0, best - kSpacing), high = best + kSpacing;
  while (high - low > 1e-13) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (depth_at(pose, angle, a) > depth_at(pose, angle, b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return std::max(depth_at(pose, angle, best), depth_at(pose, angle, low));
}

/// Returns the depth [m] of the deepest point of the tool: evaluates many angles, then ever smaller neighbourhoods of
/// the deepest angle.
double searched(const ToolPose& pose) {
  double deepest = 0.0, angle = 0.0;
  const auto search = [&](double from, double spacing, int angles) {
    for (int i = 0; i <= angles; ++i) {
      const double depth = deepest_at(pose, from + i * spacing);
      if (depth <= deepest) continue;
      deepest = depth;
      angle = from + i * spacing;
    }
  };
  constexpr double kSpacing = std::numbers::pi / 45;
  search(0.0, kSpacing, 90);
  for (double around = kSpacing; around > 1e-8; around *= 0.5) search(angle - around, around / 4, 8);
  return deepest;
}

TEST(Interpenetration, EqualsASearchOverTheWholeTool) {
  Random random(9);
  for (int run = 0; run < 40; ++run) {
    const double tilt = random.uniform(0.05, 1.2), azimuth = random.uniform(0, 6.3);
    const ToolPose pose =
        tilted({random.uniform(-7e-4, 7e-4), random.uniform(-7e-4, 7e-4), random.uniform(-4e-3, 3e-4)}, tilt, azimuth);
    EXPECT_NEAR(interpenetration(kBlock, kTool, pose), searched(pose), 2.0 * kRounding) << run;
  }
}

/// Checks a tool that is shorter than the depth of the hole and wholly below the top of the block. Its upper end may
/// then be its deepest point.
TEST(Interpenetration, KnowsTheUpperEndOfAShortTool) {
  const Cylinder tool(kTool.radius(), 0.001);
  for (const double reach : {0.0006, 0.0008}) {
    // The tool leans outwards, so that its upper end is deeper in the wall than its tip. The upper end is far below the
    // top of the block.
    const double tilt = 0.3, s = std::sin(tilt), c = std::cos(tilt);
    const ToolPose pose = tilted({reach, 0.0, -0.003}, tilt);
    EXPECT_NEAR(interpenetration(kBlock, tool, pose), reach + 0.001 * s + 0.0005 * c - 0.001, kRounding);
  }
}

TEST(PositionMetrics, TargetsNeverReachedHaveNoForceAndNoSpeed) {
  EXPECT_TRUE(position_metrics({}).empty());
  TargetRow missed, reached;
  missed.result = {0, false, 10.0};
  reached.subject = 1;
  reached.result = {0, true, 3.0};
  reached.rows_on_target = 5;
  reached.model_force = 2.0;
  const PositionMetrics metrics = position_metrics({missed, reached})[0];
  EXPECT_EQ(metrics.model_force.subjects, 1u);
  EXPECT_EQ(metrics.model_force.mean, 2.0);
  EXPECT_EQ(metrics.model_force.standard_error, 0.0);
  EXPECT_EQ(metrics.completion_time.subjects, 2u);
  EXPECT_EQ(position_metrics({missed})[0].speed.subjects, 0u);
}

/// A hand that exerts no force and has a task.
class TaskHand final : public Hand {
 public:
  explicit TaskHand(const TargetTask& task) : task_(task) {}
  void reset() noexcept override {}
  Vec3 force(double, const HandView&) noexcept override { return Vec3::Zero(); }
  const TargetTask* task() const noexcept override { return &task_; }

 private:
  const TargetTask& task_;
};

void begin(TargetMetricsObserver& observer, std::size_t subject, std::size_t trial, const TargetTask& task) {
  const SimulationConfig config;
  SimulationParts parts;
  parts.hand = std::make_unique<TaskHand>(task);
  observer.begin({config, parts, nullptr, subject, trial});
}

TEST(TargetMetrics, ALostTrialFailsTheTargetsThatAreLeft) {
  TargetRules rules;
  rules.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
  rules.targets_per_position = 2;
  TargetTask task(rules, 1);
  TargetMetricsObserver observer;
  begin(observer, 4, 5, task);
  StepRecord record;
  record.task = &task;
  record.tool.pose.position = rules.positions[task.position_index()];
  task.advance(record.tool.pose.position, 2.0, 2.0, rules.hold);
  observer.on_step(record);  // the first target is removed
  observer.fail_rest();
  ASSERT_EQ(observer.rows().size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const TargetRow& row = observer.rows()[i];
    EXPECT_EQ(row.target, i);
    EXPECT_EQ(row.result.position, task.order()[i]);
    EXPECT_EQ(row.result.removed, i == 0);
    EXPECT_EQ(row.result.time, i == 0 ? rules.hold : rules.time_limit);
    EXPECT_EQ(row.subject, 4u);
    EXPECT_EQ(row.trial, 5u);
  }
}

TEST(TargetMetrics, MeansAreOverTheRowsOnTheTargetOfTheTrial) {
  TargetRules rules;
  rules.positions = {Vec3(0, 0, 0)};
  rules.targets_per_position = 2;
  rules.tolerance = 0.0001;
  rules.logged = 0.0003;
  rules.hold = 2.0;
  TargetTask task(rules, 1);
  TargetMetricsObserver observer;
  begin(observer, 4, 5, task);
  StepRecord record;
  record.task = &task;
  const auto step = [&](double x, double force, double speed) {
    record.tool.pose.position = {x, 0, 0};
    record.force.rendered = {0, 0, force};
    record.handle.velocity = {0, speed, 0};
    task.advance(record.tool.pose.position, 2.0, 2.0, 1.0);
    observer.on_step(record);
  };
  step(0.001, 100.0, 100.0);  // off the target
  step(0.0002, 1.0, 4.0);     // near enough to be logged, not to be held
  step(0.0, 3.0, 6.0);
  step(0.0, 50.0, 50.0);  // removes the target: this step belongs to the next target
  ASSERT_EQ(observer.rows().size(), 1u);
  EXPECT_EQ(observer.rows()[0].rows_on_target, 2u);
  EXPECT_EQ(observer.rows()[0].speed, 5.0);
  step(0.0, 2.0, 0.0);
  step(0.0, 2.0, 0.0);
  ASSERT_EQ(observer.rows().size(), 2u);
  // Steps on an unfinished target do not count in the next trial, which adds its own targets.
  TargetTask next(rules, 2);
  record.task = &next;
  begin(observer, 4, 6, next);
  observer.fail_rest();
  ASSERT_EQ(observer.rows().size(), 4u);
  EXPECT_EQ(observer.rows()[2].trial, 6u);
  EXPECT_EQ(observer.rows()[2].target, 0u);
  EXPECT_EQ(reported(observer, "0.success_rate.mean"), 0.5);
}

}  // namespace
}  // namespace hapbench::target_metrics_test
