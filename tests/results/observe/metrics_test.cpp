#include "results/observe/metrics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>

#include "results/observe/contact_metrics.hpp"
#include "results/observe/energy.hpp"
#include "results/summary/allocations.hpp"
#include "tests/results/observing.hpp"
#include "tests/support/fakes.hpp"

/// Tests transitions between trials, and runs that lack the data of a metric. tests/known_answers tests the values of
/// the metrics.
namespace hapbench::metrics_test {
namespace {

using test::row;

constexpr double kDt = 0.0005;

constexpr const char* kVibration = "vibration_power_above_30Hz_m2_per_s2";

TEST(Metrics, OfSeveralTrialsAreOneLongRunButForTheSeams) {
  const ContactBuffer none(1);
  const std::vector<Vec3> velocities = {{3, 4, 0}, {3, 4, 0}, {0, 0, 0}, {0, 0, 8}, {0, 0, 2}};
  const auto add = [&](MetricsObserver& observer, std::size_t from, std::size_t to, std::size_t colliding) {
    observer.begin();
    for (std::size_t k = from; k < to; ++k) {
      StepRecord r = row(k - from, kDt * static_cast<double>(k - from), none);
      r.tool.velocity = r.force.rendered = velocities[k];
      r.colliding = colliding;
      observer.on_step(r);
    }
  };
  MetricsObserver first(kDt), second(kDt), both(kDt), turned(kDt);
  add(first, 0, 2, 3);
  add(second, 2, 5, 8);
  add(both, 0, 2, 3);
  add(both, 2, 5, 8);
  add(turned, 2, 5, 8);
  add(turned, 0, 2, 3);
  EXPECT_EQ(both.rows(), 5u);
  EXPECT_EQ(both.trial().rows, 3u);
  EXPECT_EQ(both.trial().force_max_squared, 64.0);
  EXPECT_EQ(reported(both, "velocity_total_variation_m_per_s"), 0.0 + 8.0 + 6.0) << "without the seam's 5";
  EXPECT_EQ(reported(both, "force_max_N"), 8.0);
  EXPECT_EQ(reported(turned, "force_max_N"), 8.0);
  EXPECT_EQ(reported(both, "force_step_max_N"), 8.0);
  EXPECT_EQ(reported(both, "colliding_mean"), (2 * 3 + 3 * 8) / 5.0);
  EXPECT_EQ(reported(both, "steps_in_contact"), 5.0);
  EXPECT_EQ(reported(turned, "last_contact_s"), 2 * kDt) << "the latest of all trials";
  EXPECT_EQ(reported(both, "landings"), 2.0);
  EXPECT_NEAR(reported(both, kVibration).value(),
              (2 * reported(first, kVibration).value() + 3 * reported(second, kVibration).value()) / 5.0, 1e-15);
  EXPECT_NE(both.state_hash(), turned.state_hash());
  EXPECT_FALSE(reported(both, "ratio_min"));
}

TEST(Metrics, OfNoRowsHaveNoMeansAndNoPosition) {
  const MetricsObserver none(kDt);
  for (const char* name : {"colliding_mean", "contact_share", "last_contact_s", kVibration, "force_mean_in_contact_N"})
    EXPECT_FALSE(reported(none, name)) << name;
}

/// Returns the state hash of two steps; `change` alters the second step.
std::uint64_t state_hash(const std::function<void(StepRecord&)>& change) {
  const ContactBuffer none(1);
  MetricsObserver observer(kDt);
  StepRecord r = row(0, 0.0, none);
  r.tool = {{{1, 2, 3}, Vec3::UnitZ()}, {4, 5, 6}};
  r.force.rendered = {7, 8, 9};
  observer.on_step(r);
  change(r);
  observer.on_step(r);
  return observer.state_hash();
}

TEST(StateHash, ChangesWithTheLastBitOfPositionVelocityAndForceAndWithTheirSigns) {
  const std::uint64_t unchanged = state_hash([](StepRecord&) {});
  for (const int i : {0, 1, 2}) {
    const auto next = [i](Vec3& v) { v[i] = std::nextafter(v[i], 100.0); };
    EXPECT_NE(state_hash([&](StepRecord& r) { next(r.tool.pose.position); }), unchanged);
    EXPECT_NE(state_hash([&](StepRecord& r) { next(r.tool.velocity); }), unchanged);
    EXPECT_NE(state_hash([&](StepRecord& r) { next(r.force.rendered); }), unchanged);
  }
  EXPECT_NE(state_hash([](StepRecord& r) {
              for (Vec3* v : {&r.tool.pose.position, &r.tool.velocity, &r.force.rendered}) v->x() = -v->x();
            }),
            unchanged);
}

TEST(ExplicitFrictionLimit, IsThatOfTheIntegratorsDampers) {
  const auto limit = [](const IntegratorEntry& integrator, double mu_s, double mu_f) {
    return explicit_friction_limit(integrator, 0.2, 0.0005, mu_s, mu_f);
  };
  // The damping B is stable if B dt / M < 2 for leapfrog, and < 2.7853 for rk4.
  EXPECT_DOUBLE_EQ(*limit(kLeapfrog, 5.0, 10.0), (800.0 - 5.0) / 10.0);
  EXPECT_NEAR(*limit(kRk4, 5.0, 10.0), (2.7853 * 400.0 - 5.0) / 10.0, 0.01);
  EXPECT_EQ(limit(kLeapfrog, 801.0, 1.0), 0.0) << "the constant part alone is too much";
  EXPECT_FALSE(limit(kLeapfrog, 0.0, 0.0));
  EXPECT_FALSE(limit(kLeapfrog, 799.0, 0.0)) << "the same at every force";
  EXPECT_FALSE(limit(kImplicitEuler, 5.0, 10.0)) << "implicit in it";
}

TEST(ExplicitFriction, OfSeveralTrialsIsTheSumAndTheFirstOfTheFirst) {
  const ContactBuffer none(1);
  MetricsObserver observer(kDt, {.friction_limit = 2.0});
  for (const std::vector<double>& spring_forces : std::vector<std::vector<double>>{{1.0}, {1.0, -3.0}, {3.0}}) {
    observer.begin();
    for (std::size_t k = 0; k < spring_forces.size(); ++k) {
      StepRecord r = row(k, 0.0, none);
      r.force.spring = {0.0, spring_forces[k], 0.0};
      observer.on_step(r);
    }
  }
  EXPECT_EQ(reported(observer, "explicit_friction_rows_beyond"), 2.0);
  EXPECT_EQ(reported(observer, "explicit_friction_first_step"), 1.0);
}

TEST(LostTorque, HasNoValueWithoutContact) {
  const ContactBuffer none(1);
  LostTorqueObserver observer;
  observer.on_step(row(0, 0.0, none));
  for (const char* name : {"lost_mean_Nm", "lost_max_Nm"}) EXPECT_FALSE(reported(observer, name)) << name;
}

TEST(PassivityObserver, OfSeveralTrialsTheTrialWithTheLargestCreatedEnergyCounts) {
  SimulationConfig config;
  config.dt = 0.5;
  const SimulationParts parts = test::fake_parts([](const ToolState&) { return Vec3::Zero(); });
  const ContactBuffer none(1);
  PassivityObserver observer;
  EXPECT_FALSE(reported(observer, "energy_min_J"));
  // Four trials of a tool that moves at 1 m/s. The first trial has no steps. The smallest energies of the others are
  // -1, -3 and -3 J, and their final energies are -1, -2 and -3 J.
  for (const std::vector<double>& forces : std::vector<std::vector<double>>{{}, {2, 0}, {4, 2, -2, 0}, {6, 0}}) {
    observer.begin({config, parts});
    for (std::uint64_t k = 0; k < forces.size(); ++k) {
      StepRecord r = row(k, 0.5 * static_cast<double>(k), none);
      r.tool.velocity = {1, 0, 0};
      r.force.rendered = {forces[k], 0, 0};
      observer.on_step(r);
    }
  }
  EXPECT_EQ(reported(observer, "energy_min_J"), -3.0);
  EXPECT_EQ(reported(observer, "time_of_min_s"), 1.0);
  EXPECT_EQ(reported(observer, "energy_end_J"), -2.0);
  EXPECT_EQ(observer.net_created(), 3.0) << "of the last trial";
}

ContactBuffer kept(const std::vector<std::uint32_t>& points) {
  ContactBuffer contacts(std::max<std::size_t>(points.size(), 1));
  for (const std::uint32_t point : points) contacts.push(point, Vec3::Zero(), Vec3::UnitZ());
  return contacts;
}

TEST(ReductionJumps, AreChangesOfThePointsAndTheLargestStepOfSettledOnes) {
  ReductionJumps jumps(3);
  const std::tuple<std::vector<std::uint32_t>, double, bool> rows[] = {
      {{1, 3}, 0.0, true}, {{3, 1}, 1.0, true}, {{2}, 5.0, true}, {{2}, 9.0, true}, {{3}, 9.0, false}};
  for (const auto& [points, step, settled] : rows) jumps.add(kept(points), step * step, settled);
  EXPECT_EQ(jumps.changes(), 2u) << "the same points in another order are no change";
  EXPECT_EQ(jumps.step_max(), 5.0) << "of settled rows";
}

TEST(ReductionJumps, CompareTheNumbersOfTheSamePointAsWell) {
  ReductionJumps jumps(3);
  jumps.add(kept({1, 1, 2}), 0.0, true);
  jumps.add(kept({2, 1, 1}), 0.0, true);
  EXPECT_EQ(jumps.changes(), 0u);
  jumps.add(kept({1, 2, 2}), 0.0, true);
  EXPECT_EQ(jumps.changes(), 1u);
  jumps.add(kept({2, 1}), 0.0, true);
  EXPECT_EQ(jumps.changes(), 2u) << "fewer points";
}

/// Returns the time [s] that ReductionJumps takes to process the contacts `second` after the contacts `first`: the
/// shortest time of several trials.
double shortest_row(const ContactBuffer& first, const ContactBuffer& second) {
  using Clock = std::chrono::steady_clock;
  ReductionJumps jumps(first.capacity());
  double shortest = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < 5; ++trial) {
    jumps.begin();
    jumps.add(first, 0.0, true);
    const auto start = Clock::now();
    jumps.add(second, 0.0, true);
    shortest = std::min(shortest, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return shortest;
}

// Checks how the time of one step grows with the number n of points. If n grows by a factor of 8, a time in O(n) grows
// by a factor of 8, in O(n log n) by about 10, and in O(n^2) by 64.
TEST(ReductionJumps, TakeTimeThatGrowsLessThanQuadratically) {
  constexpr std::uint32_t kFew = 2000, kGrowth = 8;
  constexpr double kMaxGrowth = 28.0;
  const auto points = [](std::uint32_t n, std::uint32_t first = 0) {
    std::vector<std::uint32_t> numbers(n);
    std::iota(numbers.begin(), numbers.end(), first);
    return numbers;
  };
  // The first point is removed, and a new point is added after the last point.
  const auto one_change = [&](std::uint32_t n) { return shortest_row(kept(points(n)), kept(points(n, 1))); };
  const auto reversed = [&](std::uint32_t n) {
    std::vector<std::uint32_t> turned = points(n);
    std::ranges::reverse(turned);
    return shortest_row(kept(points(n)), kept(turned));
  };
  EXPECT_LT(one_change(kGrowth * kFew), kMaxGrowth * one_change(kFew));
  EXPECT_LT(reversed(kGrowth * kFew), kMaxGrowth * reversed(kFew));
}

TEST(ReductionJumps, AreAMetricOfRunsWithAReductionOnly) {
  const ContactBuffer first = kept({1}), second = kept({2});
  MetricsObserver with(0.01, {.friction_limit = {}, .settling = {.from = 0.0, .time = 0.05}, .reduction_capacity = 1});
  MetricsObserver without(0.01);
  const AllocationCount allocations;
  for (std::uint64_t k = 0; k < 20; ++k) {
    if (k == 10) with.begin();  // begin a new trial, whose first step counts no change
    StepRecord r = test::row(k, 0.0, k % 2 == 0 ? first : second);
    r.force.rendered = {k % 2 == 0 ? 1.0 : 3.0, 0.0, 0.0};
    with.on_step(r);
    without.on_step(r);
  }
  EXPECT_EQ(allocations.value(), 0u);
  EXPECT_FALSE(reported(without, "reduction_changes"));
  EXPECT_EQ(reported(with, "reduction_changes"), 18.0);
  EXPECT_EQ(reported(with, "reduction_force_step_max_N"), 2.0);
}

/// Checks that the metric uses the last quarter of the steps that were made, not of the planned steps.
TEST(LastQuarterVibration, OfARunThatEndsEarlyIsThatOfARunPlannedSo) {
  for (const std::uint64_t made : {4u, 7u, 108u, 449u, 524u, 1500u, 1999u, 2000u}) {
    LastQuarterVibration planned(2000, 0.001), early(made, 0.001);
    for (std::uint64_t i = 0; i < made; ++i) {
      // The vibration decays, so that every interval has a different rms.
      const Vec3 velocity(std::sin(0.9 * static_cast<double>(i)) / (1.0 + 0.01 * static_cast<double>(i)), 0.0, 0.1);
      planned.add(i, velocity);
      early.add(i, velocity);
    }
    ASSERT_TRUE(planned.value() && early.value()) << made;
    EXPECT_NEAR(*planned.value(), *early.value(), 1e-15) << made;  // both sum the same squares in the same order
  }
}

}  // namespace
}  // namespace hapbench::metrics_test
