#include "results/observe/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "results/allocations/allocations.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::metrics_test {
namespace {

using test::contacts_along;
using test::row;

constexpr double kDt = 0.0005;

/// Rows with these velocities and nothing else.
Metrics metrics_of_velocities(const std::vector<Vec3>& velocities, double dt = kDt) {
  const ContactBuffer none(1);
  MetricsObserver observer(dt);
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    StepRecord r = row(k, dt * static_cast<double>(k), none);
    r.tool.velocity = velocities[k];
    observer.on_step(r);
  }
  return observer.metrics();
}

Metrics metrics_of_forces(const std::vector<Vec3>& forces) {
  const ContactBuffer none(1);
  MetricsObserver observer(kDt);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    StepRecord r = row(k, 0.0, none);
    r.force.rendered = forces[k];
    observer.on_step(r);
  }
  return observer.metrics();
}

// All lengths are whole numbers, so every result is exact.
TEST(Metrics, VelocityTotalVariationSumsTheChangesNotTheSpeeds) {
  const Metrics m = metrics_of_velocities({{3, 4, 0}, {3, 4, 0}, {0, 0, 0}, {0, 0, -2}, {0, 0, 2}});
  EXPECT_EQ(m.velocity_total_variation, 0.0 + 5.0 + 2.0 + 4.0);
  EXPECT_EQ(m.speed_max, 5.0);
}

TEST(Metrics, ForceReversalsCountNegativeInnerProductsOfConsecutiveRows) {
  // +x, -x (1), zero, -x, +y (orthogonal), -y (2), -y and a little x, then +y (3)
  const Metrics m =
      metrics_of_forces({{1, 0, 0}, {-2, 0, 0}, {0, 0, 0}, {-1, 0, 0}, {0, 3, 0}, {0, -1, 0}, {0.5, -1, 0}, {0, 1, 0}});
  EXPECT_EQ(m.force_reversals, 3u);
  EXPECT_EQ(m.force_max, 3.0);
}

TEST(Metrics, ForceStepMaxIsTheLargestChangeFromRowToRow) {
  EXPECT_EQ(metrics_of_forces({{9, 0, 0}, {9, 3, 4}, {9, 3, 4}, {9, 0, 4}}).force_step_max, 5.0);
  EXPECT_EQ(metrics_of_forces({{9, 0, 0}}).force_step_max, 0.0) << "a first row changes nothing";
}

TEST(Metrics, MergedRunsAreOneLongRunButForTheSeams) {
  const ContactBuffer none(1);
  const std::vector<Vec3> velocities = {{3, 4, 0}, {3, 4, 0}, {0, 0, 0}, {0, 0, 8}, {0, 0, 2}};
  const auto run = [&](std::size_t from, std::size_t to, std::size_t colliding) {
    MetricsObserver observer(kDt);
    for (std::size_t k = from; k < to; ++k) {
      StepRecord r = row(k, 0.0, none);
      r.tool.velocity = velocities[k];
      r.force.rendered = velocities[k];
      r.colliding = colliding;
      observer.on_step(r);
    }
    return observer.metrics();
  };
  const Metrics first = run(0, 2, 3), second = run(2, 5, 8), both = merged({first, second});
  EXPECT_EQ(both.rows, 5u);
  EXPECT_EQ(both.velocity_total_variation, 0.0 + 8.0 + 6.0) << "without the seam's 5";
  EXPECT_EQ(both.force_max, 8.0);
  EXPECT_EQ(both.force_step_max, 8.0);
  EXPECT_EQ(both.colliding_mean, (2 * 3 + 3 * 8) / 5.0);
  EXPECT_EQ(both.colliding_max, 8u);
  EXPECT_EQ(both.steps_in_contact, 5u);
  EXPECT_NEAR(*both.vibration_power, (2 * *first.vibration_power + 3 * *second.vibration_power) / 5.0, 1e-15);
  EXPECT_NE(both.state_hash, merged({second, first}).state_hash);
  EXPECT_EQ(merged({first}).state_hash, first.state_hash);
  EXPECT_FALSE(both.ratio);
}

TEST(Metrics, AForceThatStartsAgainstNothingIsNoReversal) {
  EXPECT_EQ(metrics_of_forces({{0, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}).force_reversals, 0u);
}

TEST(Metrics, CountContactsDepthAndRatioOverAllRows) {
  const ContactBuffer none(1);
  const ContactBuffer one = contacts_along({Vec3::UnitX()});
  const ContactBuffer three = contacts_along({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
  MetricsObserver observer(kDt);

  observer.on_step(row(0, 0.0, none));
  StepRecord r = row(1, kDt, one);
  r.colliding = 4;
  r.force.depth_max = 0.25;
  r.ratio = {0.5, 0.75};
  observer.on_step(r);
  r = row(2, 2 * kDt, three);
  r.colliding = 5;
  r.force.depth_max = 0.125;
  r.ratio = {0.625, 1.5};
  observer.on_step(r);
  // Colliding, but a point stage has dropped everything: contact without a ratio.
  r = row(3, 3 * kDt, none);
  r.colliding = 3;
  r.ratio = {};
  observer.on_step(r);

  const Metrics m = observer.metrics();
  EXPECT_EQ(m.rows, 4u);
  EXPECT_EQ(m.colliding_mean, 12.0 / 4.0);
  EXPECT_EQ(m.colliding_max, 5u);
  EXPECT_EQ(m.rendered_mean, 4.0 / 4.0);
  EXPECT_EQ(m.rendered_max, 3u);
  EXPECT_EQ(m.steps_in_contact, 3u);
  EXPECT_EQ(m.depth_max, 0.25);
  ASSERT_TRUE(m.ratio);
  EXPECT_EQ(m.ratio->min, 0.5);
  EXPECT_EQ(m.ratio->max, 1.5);
}

TEST(Metrics, OfNoRowsAreZeroAndHaveNoVibrationPower) {
  const Metrics m = MetricsObserver(kDt).metrics();
  EXPECT_EQ(m.rows, 0u);
  EXPECT_EQ(m.colliding_mean, 0.0);
  EXPECT_FALSE(m.vibration_power);
}

TEST(Metrics, VibrationPowerOfAConstantVelocityIsExactlyZero) {
  EXPECT_EQ(metrics_of_velocities(std::vector<Vec3>(100, {0.1, -0.2, 0.3})).vibration_power, 0.0);
}

std::vector<Vec3> oscillation(double frequency, double duration) {
  std::vector<Vec3> v;
  for (double t = 0.0; t < duration; t += kDt) {
    const double phase = 2.0 * std::numbers::pi * frequency * t;
    v.emplace_back(3.0 * std::sin(phase), 0.0, 4.0 * std::sin(phase));
  }
  return v;
}

/// Power gain of the documented filter.
double gain(double frequency) {
  const double ratio = std::tan(std::numbers::pi * 30.0 * kDt) / std::tan(std::numbers::pi * frequency * kDt);
  return 1.0 / (1.0 + std::pow(ratio, 8.0));
}

// Amplitude 5 m/s: mean square 25/2 behind the filter's gain. The start-up transient decays as exp(-72 t) from an
// amplitude of the order of the signal's: its energy is at most about 2/72 s of signal in 20 s, 0.14 %.
TEST(Metrics, VibrationPowerOfAFastOscillationIsItsMeanSquareBehindTheFilter) {
  const Metrics m = metrics_of_velocities(oscillation(100.0, 20.0));
  ASSERT_TRUE(m.vibration_power);
  EXPECT_NEAR(*m.vibration_power, 12.5 * gain(100.0), 12.5 * 0.0014);
}

TEST(Metrics, VibrationPowerNeedsASamplingRateAboveSixtyHertz) {
  EXPECT_FALSE(metrics_of_velocities({Vec3::Zero()}, 1.0 / 60.0).vibration_power);
  EXPECT_TRUE(metrics_of_velocities({Vec3::Zero()}, 1.0 / 61.0).vibration_power);
}

/// Two rows; `change` alters the second.
std::uint64_t state_hash(const std::function<void(StepRecord&)>& change) {
  const ContactBuffer none(1);
  MetricsObserver observer(kDt);
  StepRecord r = row(0, 0.0, none);
  r.tool = {{{1, 2, 3}, Vec3::UnitZ()}, {4, 5, 6}};
  r.force.rendered = {7, 8, 9};
  observer.on_step(r);
  change(r);
  observer.on_step(r);
  return observer.metrics().state_hash;
}

TEST(StateHash, IsTheSameForTheSameRows) {
  EXPECT_EQ(state_hash([](StepRecord&) {}), state_hash([](StepRecord&) {}));
}

TEST(StateHash, ChangesWithTheLastBitOfPositionVelocityAndForce) {
  const std::uint64_t unchanged = state_hash([](StepRecord&) {});
  for (const int i : {0, 1, 2}) {
    const auto next = [i](Vec3& v) { v[i] = std::nextafter(v[i], 100.0); };
    EXPECT_NE(state_hash([&](StepRecord& r) { next(r.tool.pose.position); }), unchanged);
    EXPECT_NE(state_hash([&](StepRecord& r) { next(r.tool.velocity); }), unchanged);
    EXPECT_NE(state_hash([&](StepRecord& r) { next(r.force.rendered); }), unchanged);
  }
}

TEST(StateHash, TellsAMirroredRunFromTheOriginal) {
  const std::uint64_t unchanged = state_hash([](StepRecord&) {});
  EXPECT_NE(state_hash([](StepRecord& r) {
              for (Vec3* v : {&r.tool.pose.position, &r.tool.velocity, &r.force.rendered}) v->x() = -v->x();
            }),
            unchanged);
}

TEST(MetricsObserver, AllocatesNothing) {
  const ContactBuffer contacts = contacts_along({Vec3::UnitX()});
  const StepRecord r = row(0, 0.0, contacts);
  const std::size_t before = heap_allocations();
  MetricsObserver observer(kDt);
  for (int k = 0; k < 100; ++k) observer.on_step(r);
  EXPECT_EQ(heap_allocations(), before);
  EXPECT_EQ(observer.metrics().rows, 100u);
}

TEST(ExplicitFrictionLimit, OfTheThesisIs79NewtonsInThePlaneAnd40OnThePlatform) {
  EXPECT_DOUBLE_EQ(*explicit_friction_limit(kLeapfrog, 0.2, 0.0005, 5.0, 10.0), (2 * 0.2 / 0.0005 - 5.0) / 10.0);
  EXPECT_DOUBLE_EQ(*explicit_friction_limit(kLeapfrog, 0.1, 1.0 / 2048, 5.0, 10.0), (2 * 0.1 * 2048 - 5.0) / 10.0);
}

TEST(ExplicitFrictionLimit, IsThatOfTheIntegratorsDampers) {
  // B dt / M < 4 for velocity Verlet, 2.7853 for rk4.
  EXPECT_DOUBLE_EQ(*explicit_friction_limit(kVelocityVerlet, 0.2, 0.0005, 5.0, 10.0), (1600.0 - 5.0) / 10.0);
  EXPECT_NEAR(*explicit_friction_limit(kRk4, 0.2, 0.0005, 5.0, 10.0), (2.7853 * 400.0 - 5.0) / 10.0, 0.01);
}

TEST(ExplicitFrictionLimit, DoesNotExistWithoutFrictionOrWhereTheIntegratorIsImplicitInIt) {
  EXPECT_FALSE(explicit_friction_limit(kLeapfrog, 0.2, 0.0005, 0.0, 0.0));
  EXPECT_FALSE(explicit_friction_limit(kLeapfrog, 0.2, 0.0005, 799.0, 0.0)) << "the same at every force";
  EXPECT_FALSE(explicit_friction_limit(kImplicitEuler, 0.2, 0.0005, 5.0, 10.0));
  EXPECT_FALSE(explicit_friction_limit(kImplicitMidpoint, 0.2, 0.0005, 5.0, 10.0));
}

TEST(ExplicitFrictionLimit, IsZeroWhereTheConstantPartAloneIsTooMuch) {
  EXPECT_EQ(*explicit_friction_limit(kLeapfrog, 0.2, 0.0005, 801.0, 0.0), 0.0);
  EXPECT_EQ(*explicit_friction_limit(kLeapfrog, 0.2, 0.0005, 801.0, 1.0), 0.0);
}

/// One damper of friction mu_f |f| under leapfrog, v <- (1 - (mu_s + mu_f |f|) dt / M) v: the speed after 100 steps
/// from 1 m/s.
double speed_after_sliding(double spring_force) {
  double v = 1.0;
  for (int i = 0; i < 100; ++i) v -= (5.0 + 10.0 * spring_force) * v / 0.2 * 0.0005;
  return std::abs(v);
}

TEST(ExplicitFrictionLimit, IsWhereSlidingStopsDying) {
  const double limit = *explicit_friction_limit(kLeapfrog, 0.2, 0.0005, 5.0, 10.0);
  EXPECT_LT(speed_after_sliding(0.99 * limit), 1.0);
  EXPECT_GT(speed_after_sliding(1.01 * limit), 1.0);
}

Metrics metrics_of(const std::vector<double>& spring_forces, std::optional<double> limit) {
  const ContactBuffer none(1);
  MetricsObserver observer(0.0005, {.friction_limit = limit});
  for (std::size_t k = 0; k < spring_forces.size(); ++k) {
    StepRecord r = test::row(k, 0.0, none);
    r.force.spring = {0.0, spring_forces[k], 0.0};
    observer.on_step(r);
  }
  return observer.metrics();
}

TEST(ExplicitFriction, CountsRowsBeyondTheLimitAndKeepsTheFirst) {
  const auto friction = metrics_of({1.0, 2.0, -3.0, 0.0, 2.5}, 2.0).explicit_friction;
  ASSERT_TRUE(friction);
  EXPECT_EQ(friction->limit, 2.0);
  EXPECT_EQ(friction->rows_beyond, 2u);
  EXPECT_EQ(friction->first_step, 2u);
  EXPECT_FALSE(metrics_of({1.0, 2.0}, 2.0).explicit_friction->first_step);
  EXPECT_FALSE(metrics_of({1e300}, std::nullopt).explicit_friction);
}

TEST(ExplicitFriction, OfMergedRunsIsTheSumAndTheFirstRunsFirst) {
  const auto friction = merged({metrics_of({1.0}, 2.0), metrics_of({1.0, 3.0}, 2.0), metrics_of({3.0}, 2.0)});
  EXPECT_EQ(friction.explicit_friction->rows_beyond, 2u);
  EXPECT_EQ(friction.explicit_friction->first_step, 1u);
}

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
}  // namespace hapbench::metrics_test
