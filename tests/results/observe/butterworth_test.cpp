#include "results/observe/contact_forces.hpp"

#include <gtest/gtest.h>

/// Known answers compare what is behind the filter with scipy's.
namespace hapbench::butterworth_test {
namespace {

TEST(HighPass, SettledAtAConstantGivesExactlyZero) {
  HighPass filter(30.0, 2000.0);
  const Vec3 value(0.1, -1e3, 1.0 / 3.0);
  filter.settle_at(value);
  for (int k = 0; k < 100; ++k) ASSERT_EQ(filter.filter(value), Vec3::Zero());
}

TEST(HighPass, SettlingForgetsThePast) {
  HighPass used(30.0, 2000.0);
  used.settle_at(Vec3::Zero());
  for (int k = 0; k < 10; ++k) used.filter({1.0, 2.0, 3.0});
  used.settle_at(Vec3::UnitX());
  HighPass fresh(30.0, 2000.0);
  fresh.settle_at(Vec3::UnitX());
  for (int k = 0; k < 10; ++k) ASSERT_EQ(used.filter(Vec3::UnitY()), fresh.filter(Vec3::UnitY()));
}

}  // namespace
}  // namespace hapbench::butterworth_test
