#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scenarios/studies/precision/measure.hpp"

namespace hapbench::measure_test {
namespace {

TEST(FittedOrder, OfAPowerIsItsExponent) {
  const std::vector<double> x = {1.0, 0.5, 0.25, 0.125};
  for (const double order : {1.0, 2.0, 4.0}) {
    std::vector<double> error;
    for (const double h : x) error.push_back(3.0 * std::pow(h, order));
    EXPECT_NEAR(fitted_order(x, error), order, 1e-12);
  }
  EXPECT_TRUE(std::isnan(fitted_order(x, std::vector<double>{1.0, 0.0, 0.0, 0.0}))) << "one point is no line";
  EXPECT_NEAR(fitted_order(x, std::vector<double>{1.0, 0.5, std::nan(""), 0.125}), 1.0, 1e-12) << "failures left out";
}

TEST(Distance, IsThatOfTheCommonSamples) {
  const std::vector<Vec3> a = {{0, 0, 0}, {3, 4, 0}, {9, 9, 9}}, b = {{0, 0, 1}, {0, 0, 0}};
  const TrajectoryDistance d = distance(a, b);
  EXPECT_EQ(d.final, 5.0);
  EXPECT_EQ(d.max, 5.0);
  EXPECT_NEAR(d.rms, std::sqrt(13.0), 1e-15);
}

}  // namespace
}  // namespace hapbench::measure_test
