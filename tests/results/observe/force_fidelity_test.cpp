#include "results/observe/force_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace hapbench::force_fidelity_test {
namespace {

constexpr double kDt = 0.001;

TEST(ForceFidelity, WhereNothingIsRenderedTheNormalIsTheMeasuredForces) {
  const ReferenceForce measured({{0.0, {0.3, 0, 2}}, {1.0, {0.3, 0, 2}}});
  ForceFidelityObserver observer(measured, kDt, 1);
  observer.on_step({});
  EXPECT_NEAR(told(observer, "force_error_normal_rms_N").value(), told(observer, "reference_force_rms_N").value(),
              1e-15);
  EXPECT_NEAR(told(observer, "force_error_tangential_rms_N").value(), 0.0, 1e-15);
  EXPECT_EQ(told(observer, "direction_rows"), 0.0);
}

TEST(ForceFidelity, TakesTheLagNearestToZeroOfPeriodicForces) {
  for (const double frequency : {8.0, 10.0, 12.0, 15.0, 20.0, 50.0}) {
    for (const double part : {0.0, 0.3, -0.2}) {  // of a period
      std::vector<Vec3> early, late;
      for (int k = 0; k < 3000; ++k) {
        const double phase = 2.0 * std::numbers::pi * frequency * kDt * k;
        early.push_back({0, 0, 1.0 + std::sin(phase)});
        late.push_back({0, 0, 1.0 + std::sin(phase - 2.0 * std::numbers::pi * part)});
      }
      const auto found = lag_between(early, late, kDt, kMostLag);
      ASSERT_TRUE(found) << frequency;
      EXPECT_NEAR(found->time, part / frequency, 0.05 * kDt) << frequency << " Hz, " << part;
      // A second answer is within reach for periods up to the range on the other side of 0, and at its end (10 Hz, 0).
      const double other = (1.0 - std::abs(part)) / frequency;
      ASSERT_EQ(found->period.has_value(), other < kMostLag + 0.5 * kDt) << frequency << " Hz, " << part;
      EXPECT_NEAR(found->period.value_or(1.0 / frequency), 1.0 / frequency, 0.6 * kDt);
    }
  }
}

TEST(ForceFidelity, FindsNoLagBeyondItsReach) {
  std::vector<Vec3> early, late;
  for (int k = 0; k < 3000; ++k) {
    early.push_back({0, 0, kDt * k});
    late.push_back({0, 0, std::max(0.0, kDt * (k - 500))});
  }
  EXPECT_FALSE(lag_between(early, std::vector<Vec3>(3000, Vec3(0, 0, 1)), kDt, kMostLag));
  EXPECT_FALSE(lag_between({}, {}, kDt, kMostLag));
  EXPECT_FALSE(lag_between(early, late, kDt, kMostLag)) << "0.5 s late";
}

}  // namespace
}  // namespace hapbench::force_fidelity_test
