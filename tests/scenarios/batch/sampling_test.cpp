#include "scenarios/batch/sampling.hpp"

#include <gtest/gtest.h>

#include <set>

/// The errors for wrong samples are in tests/data/golden/refused_sweeps.txt.
namespace hapbench::sampling_test {
namespace {

TEST(Sampling, HasItsPointsInTheUnitCubeAndMeansWhatItsSeedSays) {
  for (const std::string_view method : {kLatinHypercube, kRandomPoints}) {
    std::set<std::vector<double>> different;
    for (const std::uint64_t seed : {1u, 2u}) {
      for (std::size_t axis = 0; axis < 12; ++axis) {
        const std::vector<double> points = unit_sample({method, 100, seed}, axis);
        ASSERT_EQ(points.size(), 100u);
        std::set<std::size_t> strata;
        for (const double x : points) {
          EXPECT_TRUE(x >= 0.0 && x < 1.0);
          strata.insert(static_cast<std::size_t>(x * 100.0));
        }
        EXPECT_EQ(strata.size() == 100u, method == kLatinHypercube) << "one point in each stratum";
        EXPECT_EQ(unit_sample({method, 100, seed}, axis), points);
        different.insert(points);
      }
    }
    EXPECT_EQ(different.size(), 24u);
  }
}

}  // namespace
}  // namespace hapbench::sampling_test
