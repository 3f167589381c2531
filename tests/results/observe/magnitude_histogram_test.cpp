#include "results/observe/magnitude_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/core/random.hpp"

namespace hapbench::magnitude_histogram_test {
namespace {

MagnitudeHistogram histogram_of(const std::vector<double>& numbers) {
  MagnitudeHistogram histogram;
  for (const double number : numbers) histogram.add_square(number * number);
  return histogram;
}

/// Numbers spread evenly over the exponents from 1e-8 to 1e5.
std::vector<double> many_numbers() {
  Random random(5);
  std::vector<double> numbers(20'000);
  for (double& number : numbers) number = std::pow(10.0, random.uniform(-8.0, 5.0));
  return numbers;
}

TEST(MagnitudeHistogram, GivesNearestRankQuantilesWithinItsError) {
  std::vector<double> numbers = many_numbers();
  const MagnitudeHistogram histogram = histogram_of(numbers);
  std::sort(numbers.begin(), numbers.end());
  double largest = 0.0;
  for (const double p : {0.001, 0.1, 0.25, 0.5, 0.9, 0.99, 0.9999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(numbers.size())));
    const double exact = numbers[rank - 1];
    const double error = std::abs(histogram.quantile(p) / exact - 1.0);
    EXPECT_LE(error, MagnitudeHistogram::kRelativeError) << p;
    largest = std::max(largest, error);
  }
  EXPECT_GT(largest, 0.1 * MagnitudeHistogram::kRelativeError) << "the stated error is not far too large";
}

// Every bin, at its lower edge and just below: the numbers that are furthest from its middle.
TEST(MagnitudeHistogram, ErrorOfEveryBinIsTheStatedOne) {
  double largest = 0.0;
  for (double edge = MagnitudeHistogram::kLeast; edge < MagnitudeHistogram::kMost; edge *= std::sqrt(33.0 / 32.0)) {
    for (const double number : {edge, std::nextafter(edge, 0.0) * (1.0 - 1e-12)}) {
      if (number < MagnitudeHistogram::kLeast) continue;
      largest = std::max(largest, std::abs(histogram_of({number}).quantile(1.0) / number - 1.0));
    }
  }
  EXPECT_LE(largest, MagnitudeHistogram::kRelativeError);
  EXPECT_GT(largest, 0.9 * MagnitudeHistogram::kRelativeError);
}

TEST(MagnitudeHistogram, TakesNumbersBeyondItsEndsAsZeroAndInfinity) {
  EXPECT_EQ(histogram_of({0.0}).quantile(1.0), 0.0);
  EXPECT_EQ(histogram_of({0.9 * MagnitudeHistogram::kLeast}).quantile(1.0), 0.0);
  EXPECT_NEAR(histogram_of({MagnitudeHistogram::kLeast}).quantile(1.0), MagnitudeHistogram::kLeast,
              MagnitudeHistogram::kRelativeError * MagnitudeHistogram::kLeast);
  EXPECT_EQ(histogram_of({MagnitudeHistogram::kMost}).quantile(1.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(histogram_of({1e300}).quantile(1.0), std::numeric_limits<double>::infinity());
}

TEST(MagnitudeHistogram, OfSeveralSetsIsTheSumInAnyOrder) {
  const std::vector<double> numbers = many_numbers();
  const std::vector<double> first(numbers.begin(), numbers.begin() + 7000),
      second(numbers.begin() + 7000, numbers.end());
  MagnitudeHistogram forwards = histogram_of(first), backwards = histogram_of(second);
  forwards += histogram_of(second);
  backwards += histogram_of(first);
  for (const double p : {0.01, 0.5, 0.99}) {
    EXPECT_EQ(forwards.quantile(p), histogram_of(numbers).quantile(p));
    EXPECT_EQ(backwards.quantile(p), histogram_of(numbers).quantile(p));
  }
}

}  // namespace
}  // namespace hapbench::magnitude_histogram_test
