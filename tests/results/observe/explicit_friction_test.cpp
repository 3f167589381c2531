#include "results/observe/explicit_friction.hpp"

#include <gtest/gtest.h>

#include "results/observe/metrics.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::explicit_friction_test {
namespace {

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

}  // namespace
}  // namespace hapbench::explicit_friction_test
