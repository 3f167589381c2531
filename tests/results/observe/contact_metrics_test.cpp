#include "results/observe/contact_metrics.hpp"

#include <gtest/gtest.h>

#include "tests/results/rows.hpp"

namespace hapbench::contact_metrics_test {
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
  EXPECT_EQ(told(observer, "lost_mean_Nm"), 3.0);
  EXPECT_EQ(told(observer, "lost_max_Nm"), 5.0);
}

TEST(LostTorque, HasNoValueWithoutContact) {
  const ContactBuffer none(1);
  LostTorqueObserver observer;
  observer.on_step(test::row(0, 0.0, none));
  for (const Metric& metric : told(observer)) {
    EXPECT_TRUE(std::holds_alternative<std::monostate>(metric.value)) << metric.name;
  }
}

}  // namespace
}  // namespace hapbench::contact_metrics_test
