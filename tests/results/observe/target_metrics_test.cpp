#include "results/observe/target_metrics.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "sim/loop/simulation.hpp"

namespace hapbench::target_metrics_test {
namespace {

TEST(PlaceMetrics, TargetsNeverReachedHaveNoForceAndNoSpeed) {
  EXPECT_TRUE(place_metrics({}).empty());
  TargetRow missed, reached;
  missed.result = {0, false, 10.0};
  reached.subject = 1;
  reached.result = {0, true, 3.0};
  reached.rows_on_target = 5;
  reached.model_force = 2.0;
  const PlaceMetrics place = place_metrics({missed, reached})[0];
  EXPECT_EQ(place.model_force.subjects, 1u);
  EXPECT_EQ(place.model_force.mean, 2.0);
  EXPECT_EQ(place.model_force.standard_error, 0.0);
  EXPECT_EQ(place.completion_time.subjects, 2u);
  EXPECT_EQ(place_metrics({missed})[0].speed.subjects, 0u);
}

/// A hand with a task, whose trial can begin.
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
  rules.places = {Vec3(0, 0, 0), Vec3(1, 0, 0)};
  rules.targets_per_place = 2;
  TargetTask task(rules, 1);
  TargetMetricsObserver observer;
  begin(observer, 4, 5, task);
  StepRecord record;
  record.task = &task;
  record.tool.pose.position = rules.places[task.place()];
  task.advance(record.tool.pose.position, 2.0, 2.0, rules.hold);
  observer.on_step(record);  // the first target is removed
  observer.fail_rest();
  ASSERT_EQ(observer.rows().size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const TargetRow& row = observer.rows()[i];
    EXPECT_EQ(row.target, i);
    EXPECT_EQ(row.result.place, task.order()[i]);
    EXPECT_EQ(row.result.removed, i == 0);
    EXPECT_EQ(row.result.time, i == 0 ? rules.hold : rules.time_limit);
    EXPECT_EQ(row.subject, 4u);
    EXPECT_EQ(row.trial, 5u);
  }
}

TEST(TargetMetrics, MeansAreOverTheRowsOnTheTargetOfTheTrial) {
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0)};
  rules.targets_per_place = 2;
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
  step(0.0, 50.0, 50.0);  // removes the target: this row is the next one's
  ASSERT_EQ(observer.rows().size(), 1u);
  EXPECT_EQ(observer.rows()[0].rows_on_target, 2u);
  EXPECT_EQ(observer.rows()[0].speed, 5.0);
  step(0.0, 2.0, 0.0);
  step(0.0, 2.0, 0.0);
  ASSERT_EQ(observer.rows().size(), 2u);
  // Rows on a target that has not ended do not count in the next trial, which adds rows of its own.
  TargetTask next(rules, 2);
  record.task = &next;
  begin(observer, 4, 6, next);
  observer.fail_rest();
  ASSERT_EQ(observer.rows().size(), 4u);
  EXPECT_EQ(observer.rows()[2].trial, 6u);
  EXPECT_EQ(observer.rows()[2].target, 0u);
  EXPECT_EQ(told(observer, "0.success_rate.mean"), 0.5);
}

}  // namespace
}  // namespace hapbench::target_metrics_test
