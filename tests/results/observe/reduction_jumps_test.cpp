#include "results/observe/reduction_jumps.hpp"

#include <gtest/gtest.h>

#include "results/allocations/allocations.hpp"
#include "results/observe/metrics.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::reduction_jumps_test {
namespace {

ContactBuffer kept(const std::vector<std::uint32_t>& points) {
  ContactBuffer contacts(std::max<std::size_t>(points.size(), 1));
  for (const std::uint32_t point : points) contacts.push(point, Vec3::Zero(), Vec3::UnitZ());
  return contacts;
}

TEST(ReductionJumps, CountRowsWithOtherPointsWhileInContact) {
  ReductionJumpObserver observer(3);
  const auto add = [&observer](const std::vector<std::uint32_t>& points, double step, bool settled = true) {
    observer.add(kept(points), step * step, settled);
  };
  add({}, 0.0);
  add({1, 2}, 9.0);     // a touch
  add({2, 1}, 0.25);    // the same points in another order
  add({2, 3}, 2.0);     // one other point
  add({2, 3, 4}, 3.0);  // one more
  add({2, 3}, 7.0, false);
  add({}, 0.5);  // let go
  const ReductionJumps& jumps = observer.jumps();
  EXPECT_EQ(jumps.changes, 3u);
  EXPECT_EQ(jumps.step_max(), 3.0) << "of settled rows";
  EXPECT_EQ(jumps.step_max_elsewhere(), 9.0);
  EXPECT_FALSE(jumps.stand_out());
}

TEST(ReductionJumps, LeaveOutTheRowAfterAChangeElsewhere) {
  ReductionJumpObserver observer(1);
  const std::pair<std::uint32_t, double> rows[] = {{1, 0.0}, {1, 1.0}, {2, 5.0}, {2, 4.0}, {2, 2.0}, {2, 1.0}};
  for (const auto& [point, step] : rows) observer.add(kept({point}), step * step, true);
  EXPECT_EQ(observer.jumps().step_max(), 5.0);
  EXPECT_EQ(observer.jumps().step_max_elsewhere(), 2.0);
}

TEST(ReductionJumps, StandOutWhereTheForceStepsThreeTimesAsFar) {
  EXPECT_FALSE((ReductionJumps{5, 9.0, 1.0}.stand_out()));
  EXPECT_TRUE((ReductionJumps{5, 9.1, 1.0}.stand_out()));
  EXPECT_TRUE((ReductionJumps{5, 1e-6, 0.0}.stand_out()));
  EXPECT_FALSE((ReductionJumps{5, std::nullopt, 0.0}.stand_out())) << "only in landings";
}

TEST(ReductionJumps, OfSeveralRunsAddUp) {
  ReductionJumps jumps = {2, std::nullopt, 4.0};
  jumps += {3, 1.0, 1.0};
  jumps += {1, std::nullopt, 0.0};
  EXPECT_EQ(jumps.changes, 6u);
  EXPECT_EQ(jumps.step_max(), 1.0);
  EXPECT_EQ(jumps.step_max_elsewhere(), 2.0);
}

TEST(ReductionJumps, AreAMetricOfRunsWithAReductionOnly) {
  const ContactBuffer first = kept({1}), second = kept({2});
  MetricsObserver with(0.01, {.friction_limit = {}, .settling = {.from = 0.0, .time = 0.05}, .most_reduced = 1});
  MetricsObserver without(0.01);
  const std::size_t before = heap_allocations();
  for (std::uint64_t k = 0; k < 10; ++k) {
    StepRecord r = test::row(k, 0.0, k % 2 == 0 ? first : second);
    r.force.rendered = {k % 2 == 0 ? 1.0 : 3.0, 0.0, 0.0};
    with.on_step(r);
    without.on_step(r);
  }
  EXPECT_EQ(heap_allocations(), before);
  EXPECT_FALSE(without.metrics().reduction);
  ASSERT_TRUE(with.metrics().reduction);
  EXPECT_EQ(with.metrics().reduction->changes, 9u);
  EXPECT_EQ(with.metrics().reduction->step_max(), 2.0);
  EXPECT_EQ(merged({with.metrics(), with.metrics()}).reduction->changes, 18u);
  EXPECT_FALSE(merged({without.metrics(), without.metrics()}).reduction);
}

}  // namespace
}  // namespace hapbench::reduction_jumps_test
