#include "results/observe/force_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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
