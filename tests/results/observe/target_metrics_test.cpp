#include "results/observe/target_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "sim/loop/simulation.hpp"

namespace hapbench::target_metrics_test {
namespace {

TargetRow row(std::size_t subject, std::size_t place, bool removed, double time, std::uint64_t rows, double force) {
  TargetRow r;
  r.subject = subject;
  r.result = {place, removed, time};
  r.rows_on_target = rows;
  r.model_force = force;
  r.speed = force / 100.0;
  return r;
}

TEST(PlaceMetrics, EverySubjectCountsOnceWhateverItsTargets) {
  const auto places = place_metrics({row(0, 1, true, 2.0, 5, 1.0), row(0, 1, false, 10.0, 5, 3.0),
                                     row(1, 1, true, 4.0, 5, 4.0), row(2, 1, true, 5.0, 5, 6.0)});
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].place, 1u);
  // Subject means: rates 1/2, 1, 1; times 6, 4, 5; forces 2, 4, 6.
  EXPECT_NEAR(places[0].success_rate.mean, 2.5 / 3.0, 1e-15);
  EXPECT_NEAR(places[0].completion_time.mean, 5.0, 1e-15);
  EXPECT_NEAR(places[0].completion_time.standard_error, 1.0 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(places[0].model_force.mean, 4.0, 1e-15);
  EXPECT_NEAR(places[0].model_force.standard_error, 2.0 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(places[0].success_rate.subjects, 3u);
}

TEST(PlaceMetrics, TargetsNeverReachedHaveNoForceAndNoSpeed) {
  const auto places = place_metrics({row(0, 0, false, 10.0, 0, 0.0), row(1, 0, true, 3.0, 5, 2.0)});
  EXPECT_EQ(places[0].model_force.subjects, 1u);
  EXPECT_EQ(places[0].model_force.mean, 2.0);
  EXPECT_EQ(places[0].model_force.standard_error, 0.0);
  EXPECT_EQ(places[0].completion_time.subjects, 2u);
  EXPECT_EQ(place_metrics({row(0, 0, false, 10.0, 0, 0.0)})[0].speed.subjects, 0u);
}

TEST(PlaceMetrics, PlacesAreKeptApart) {
  const auto places = place_metrics({row(0, 2, true, 1.0, 1, 1.0), row(0, 0, false, 10.0, 1, 2.0)});
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].place, 0u);
  EXPECT_EQ(places[1].place, 2u);
  EXPECT_EQ(places[1].success_rate.mean, 1.0);
  EXPECT_TRUE(place_metrics({}).empty());
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

TEST(TargetMetrics, ForceAndSpeedMayBeLoggedWithinAnotherDistanceThanTheTolerance) {
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0)};
  rules.targets_per_place = 1;
  rules.tolerance = 0.0001;
  rules.logged = 0.0003;
  rules.hold = 10.0;
  rules.time_limit = 4.0;
  TargetTask task(rules, 1);
  TargetMetricsObserver observer;
  begin(observer, 0, 0, task);
  StepRecord record;
  record.task = &task;
  for (const double x : {0.0, 0.0002, 0.0004, 0.0}) {
    record.tool.pose.position = {x, 0, 0};
    record.force.rendered = {0, 0, 1e4 * x};
    task.advance(record.tool.pose.position, 2.0, 2.0, 1.0);
    observer.on_step(record);
  }
  // The row that ends the target is the next one's; of the others, 0 and 0.2 mm are near enough.
  ASSERT_EQ(observer.rows().size(), 1u);
  EXPECT_EQ(observer.rows()[0].rows_on_target, 2u);
  EXPECT_EQ(observer.rows()[0].model_force, 1.0);
}

TEST(TargetMetrics, MeansAreOverTheRowsOnTheTarget) {
  TargetRules rules;
  rules.places = {Vec3(0, 0, 0)};
  rules.targets_per_place = 2;
  rules.hold = 3.0;
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
  step(0.0001, 1.0, 4.0);
  step(0.0, 3.0, 6.0);
  EXPECT_TRUE(observer.rows().empty());
  step(0.0, 50.0, 50.0);  // removes the target: this row is the next one's
  ASSERT_EQ(observer.rows().size(), 1u);
  const TargetRow& row = observer.rows()[0];
  EXPECT_EQ(row.subject, 4u);
  EXPECT_EQ(row.trial, 5u);
  EXPECT_EQ(row.target, 0u);
  EXPECT_TRUE(row.result.removed);
  EXPECT_EQ(row.rows_on_target, 2u);
  EXPECT_EQ(row.model_force, 2.0);
  EXPECT_EQ(row.speed, 5.0);
  step(0.0, 2.0, 0.0);
  step(0.0, 2.0, 0.0);
  step(0.0, 2.0, 0.0);
  ASSERT_EQ(observer.rows().size(), 2u);
  EXPECT_EQ(observer.rows()[1].target, 1u);
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
