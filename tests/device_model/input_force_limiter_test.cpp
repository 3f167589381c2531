#include "device_model/input_force_limiter.hpp"

#include <gtest/gtest.h>

#include "sim/core/random.hpp"

namespace hapbench::input_force_limiter_test {
namespace {

TEST(InputForceLimiter, ScalesLongerForcesToTheLimitAndKeepsTheirDirection) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 u = random.direction();
    const double limit = random.uniform(0.1, 10.0);
    const Vec3 limited = limit_input_force(limit * random.uniform(1.0, 100.0) * u, limit);
    EXPECT_LE((limited - limit * u).norm(), 4 * std::numeric_limits<double>::epsilon() * limit);
  }
}

TEST(InputForceLimiter, LeavesShorterForcesUntouched) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 force = random.uniform() * random.direction();
    EXPECT_EQ(limit_input_force(force, 1.0), force);
  }
  EXPECT_EQ(limit_input_force({3, 4, 0}, 5.0), Vec3(3, 4, 0)) << "the limit itself";
  EXPECT_EQ(limit_input_force({0, 0, 0}, 5.0), Vec3(0, 0, 0));
}

TEST(InputForceLimiter, AZeroLimitTakesTheHandAway) {
  EXPECT_EQ(limit_input_force({3, 4, 0}, 0.0), Vec3(0, 0, 0));
  EXPECT_EQ(limit_input_force({0, 0, 0}, 0.0), Vec3(0, 0, 0));
}

}  // namespace
}  // namespace hapbench::input_force_limiter_test
