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
MetricsObserver of_velocities(const std::vector<Vec3>& velocities, double dt = kDt) {
  const ContactBuffer none(1);
  MetricsObserver observer(dt);
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    StepRecord r = row(k, dt * static_cast<double>(k), none);
    r.tool.velocity = velocities[k];
    observer.on_step(r);
  }
  return observer;
}

MetricsObserver of_forces(const std::vector<Vec3>& forces) {
  const ContactBuffer none(1);
  MetricsObserver observer(kDt);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    StepRecord r = row(k, 0.0, none);
    r.force.rendered = forces[k];
    observer.on_step(r);
  }
  return observer;
}

constexpr const char* kVibration = "vibration_power_above_30Hz_m2_per_s2";

// All lengths are whole numbers, so every result is exact.
TEST(Metrics, ForceReversalsCountNegativeInnerProductsOfConsecutiveRows) {
  // +x, -x (1), zero, -x, +y (orthogonal), -y (2), -y and a little x, then +y (3)
  const MetricsObserver m =
      of_forces({{1, 0, 0}, {-2, 0, 0}, {0, 0, 0}, {-1, 0, 0}, {0, 3, 0}, {0, -1, 0}, {0.5, -1, 0}, {0, 1, 0}});
  EXPECT_EQ(told(m, "force_reversals"), 3.0);
  EXPECT_EQ(told(m, "force_max_N"), 3.0);
  EXPECT_EQ(told(of_forces({{0, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}), "force_reversals"), 0.0)
      << "a force that starts against nothing";
}

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
  EXPECT_EQ(told(both, "velocity_total_variation_m_per_s"), 0.0 + 8.0 + 6.0) << "without the seam's 5";
  EXPECT_EQ(told(both, "force_max_N"), 8.0);
  EXPECT_EQ(told(turned, "force_max_N"), 8.0);
  EXPECT_EQ(told(both, "force_step_max_N"), 8.0);
  EXPECT_EQ(told(both, "colliding_mean"), (2 * 3 + 3 * 8) / 5.0);
  EXPECT_EQ(told(both, "steps_in_contact"), 5.0);
  EXPECT_EQ(told(turned, "last_contact_s"), 2 * kDt) << "the latest of all trials";
  EXPECT_EQ(told(both, "landings"), 2.0);
  EXPECT_NEAR(told(both, kVibration).value(),
              (2 * told(first, kVibration).value() + 3 * told(second, kVibration).value()) / 5.0, 1e-15);
  EXPECT_NE(both.state_hash(), turned.state_hash());
  EXPECT_FALSE(told(both, "ratio_min"));
}

TEST(Metrics, OfNoRowsHaveNoMeansAndNoPlace) {
  const MetricsObserver none(kDt);
  for (const char* name : {"colliding_mean", "contact_share", "last_contact_s", kVibration, "force_mean_in_contact_N"})
    EXPECT_FALSE(told(none, name)) << name;
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
  EXPECT_NEAR(told(of_velocities(oscillation(100.0, 20.0)), kVibration).value(), 12.5 * gain(100.0), 12.5 * 0.0014);
}

TEST(Metrics, VibrationPowerNeedsASamplingRateAboveSixtyHertz) {
  EXPECT_FALSE(told(of_velocities({Vec3::Zero()}, 1.0 / 60.0), kVibration));
  EXPECT_TRUE(told(of_velocities({Vec3::Zero()}, 1.0 / 61.0), kVibration));
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
  return observer.state_hash();
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
  EXPECT_EQ(observer.rows(), 100u);
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

using Forces = std::vector<double>;

std::optional<ExplicitFriction> friction_of(const std::vector<Forces>& trials, std::optional<double> limit) {
  const ContactBuffer none(1);
  MetricsObserver observer(0.0005, {.friction_limit = limit});
  for (const Forces& spring_forces : trials) {
    observer.begin();
    for (std::size_t k = 0; k < spring_forces.size(); ++k) {
      StepRecord r = test::row(k, 0.0, none);
      r.force.spring = {0.0, spring_forces[k], 0.0};
      observer.on_step(r);
    }
  }
  return observer.explicit_friction();
}

TEST(ExplicitFriction, CountsRowsBeyondTheLimitAndKeepsTheFirst) {
  const auto friction = friction_of({{1.0, 2.0, -3.0, 0.0, 2.5}}, 2.0);
  ASSERT_TRUE(friction);
  EXPECT_EQ(friction->limit, 2.0);
  EXPECT_EQ(friction->rows_beyond, 2u);
  EXPECT_EQ(friction->first_step, 2u);
  EXPECT_FALSE(friction_of({{1.0, 2.0}}, 2.0)->first_step);
  EXPECT_FALSE(friction_of({{1e300}}, std::nullopt));
}

TEST(ExplicitFriction, OfSeveralTrialsIsTheSumAndTheFirstOfTheFirst) {
  const auto friction = friction_of({{1.0}, {1.0, 3.0}, {3.0}}, 2.0);
  EXPECT_EQ(friction->rows_beyond, 2u);
  EXPECT_EQ(friction->first_step, 1u);
}

ContactBuffer kept(const std::vector<std::uint32_t>& points) {
  ContactBuffer contacts(std::max<std::size_t>(points.size(), 1));
  for (const std::uint32_t point : points) contacts.push(point, Vec3::Zero(), Vec3::UnitZ());
  return contacts;
}

/// A row: its points, its force step [N], and whether it is in settled contact.
struct KeptRow {
  std::vector<std::uint32_t> points;
  double step = 0.0;
  bool settled = true;
};

ReductionJumps jumps_of(const std::vector<KeptRow>& rows) {
  ReductionJumps jumps(3);
  for (const KeptRow& row : rows) jumps.add(kept(row.points), row.step * row.step, row.settled);
  return jumps;
}

TEST(ReductionJumps, CountRowsWithOtherPointsWhileInContact) {
  const ReductionJumps jumps = jumps_of({{{}},
                                         {{1, 2}, 9.0},     // a touch
                                         {{2, 1}, 0.25},    // the same points in another order
                                         {{2, 3}, 2.0},     // one other point
                                         {{2, 3, 4}, 3.0},  // one more
                                         {{2, 3}, 7.0, false},
                                         {{}, 0.5}});  // let go
  EXPECT_EQ(jumps.changes(), 3u);
  EXPECT_EQ(jumps.step_max(), 3.0) << "of settled rows";
  EXPECT_EQ(jumps.step_max_elsewhere(), 9.0);
  EXPECT_FALSE(jumps.stand_out());
}

TEST(ReductionJumps, LeaveOutTheRowAfterAChangeElsewhere) {
  const ReductionJumps jumps = jumps_of({{{1}}, {{1}, 1.0}, {{2}, 5.0}, {{2}, 4.0}, {{2}, 2.0}, {{2}, 1.0}});
  EXPECT_EQ(jumps.step_max(), 5.0);
  EXPECT_EQ(jumps.step_max_elsewhere(), 2.0);
}

TEST(ReductionJumps, StandOutWhereTheForceStepsThreeTimesAsFar) {
  const auto stand_out = [](double there, double elsewhere, bool settled = true) {
    return jumps_of({{{1}, elsewhere}, {{2}, there, settled}}).stand_out();
  };
  EXPECT_FALSE(stand_out(3.0, 1.0));
  EXPECT_TRUE(stand_out(3.1, 1.0));
  EXPECT_TRUE(stand_out(1e-6, 0.0));
  EXPECT_FALSE(stand_out(5.0, 0.0, false)) << "only in landings";
}

TEST(ReductionJumps, AreAMetricOfRunsWithAReductionOnly) {
  const ContactBuffer first = kept({1}), second = kept({2});
  MetricsObserver with(0.01, {.friction_limit = {}, .settling = {.from = 0.0, .time = 0.05}, .most_reduced = 1});
  MetricsObserver without(0.01);
  const std::size_t before = heap_allocations();
  for (std::uint64_t k = 0; k < 20; ++k) {
    if (k == 10) with.begin();  // a trial, whose first row changes nothing
    StepRecord r = test::row(k, 0.0, k % 2 == 0 ? first : second);
    r.force.rendered = {k % 2 == 0 ? 1.0 : 3.0, 0.0, 0.0};
    with.on_step(r);
    without.on_step(r);
  }
  EXPECT_EQ(heap_allocations(), before);
  EXPECT_FALSE(told(without, "reduction_changes"));
  EXPECT_EQ(told(with, "reduction_changes"), 18.0);
  EXPECT_EQ(told(with, "reduction_force_step_max_N"), 2.0);
}

}  // namespace
}  // namespace hapbench::metrics_test
