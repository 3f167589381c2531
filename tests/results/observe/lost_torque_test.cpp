#include "results/observe/lost_torque.hpp"

#include <gtest/gtest.h>

#include "results/io/columns.hpp"
#include "results/observe/approach.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::lost_torque_test {
namespace {

TEST(LostTorque, IsAveragedOverTheRowsInContact) {
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()}), none(1);
  LostTorqueObserver observer;
  EXPECT_TRUE(observer.wants_springs());
  StepRecord row = test::row(0, 0.0, contacts);
  row.springs.moment = {3, 0, -4};
  observer.on_step(row);
  observer.on_step(test::row(1, 0.0, none));
  row.springs.moment = {0, 1, 0};
  observer.on_step(row);
  const LostTorqueMetrics metrics = observer.metrics();
  EXPECT_EQ(metrics.rows_in_contact, 2u);
  EXPECT_EQ(metrics.mean, 3.0);
  EXPECT_EQ(metrics.max, 5.0);
}

TEST(LostTorque, HasNoValueWithoutContact) {
  const ContactBuffer none(1);
  LostTorqueObserver observer;
  observer.on_step(test::row(0, 0.0, none));
  for (const Metric& metric : metric_list(observer.metrics())) {
    EXPECT_TRUE(std::holds_alternative<std::monostate>(metric.value)) << metric.name;
  }
}

/// The approach of a tool whose tip centre is at these places, a second apart, to the cube from -1 to 1.
Approach approach_of(const std::vector<Vec3>& places) {
  const ContactBuffer none(1);
  ApproachObserver observer({-Vec3::Ones(), Vec3::Ones()});
  for (std::size_t k = 0; k < places.size(); ++k) {
    StepRecord row = test::row(k, static_cast<double>(k), none);
    row.tool.pose.position = places[k];
    observer.on_step(row);
  }
  return observer.approach();
}

TEST(Approach, IsMeasuredFromTheBoxInEveryDirection) {
  EXPECT_EQ(approach_of({{0, 0, 3}}).last, 2.0);
  EXPECT_EQ(approach_of({{-4, 0, 5}}).last, 5.0);  // from an edge
  EXPECT_EQ(approach_of({{3, 4, -3}}).last, std::sqrt(4.0 + 9.0 + 4.0));
  EXPECT_EQ(approach_of({{0.5, -1, 0}}).last, 0.0);
}

TEST(Approach, KeepsTheFirstOfTheClosestRows) {
  const Approach approach = approach_of({{0, 0, 9}, {0, 0, 3}, {3, 0, 0}, {0, 7, 0}});
  EXPECT_EQ(approach.closest, 2.0);
  EXPECT_EQ(approach.closest_time, 1.0);
  EXPECT_EQ(approach.last, 6.0);
}

}  // namespace
}  // namespace hapbench::lost_torque_test
