#include "scenarios/batch/sweep_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scenarios/batch/sampling.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/input/text_lines.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::sweep_points_test {
namespace {

using Values = std::vector<std::string>;

Values values_of(const std::string& text) {
  const Axis axis = parse_axis(text);
  Values values;
  for (std::size_t i = 0; i < axis.size(); ++i) values.push_back(axis.value(i));
  return values;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& value : values_of(text)) numbers.push_back(test::number_in(value));
  return numbers;
}

TEST(Axis, OfALinearRangeHasBothEndsAndDecimalsAsOneWritesThem) {
  EXPECT_EQ(parse_axis("a.b=0:1:11").path, "a.b");
  EXPECT_EQ(values_of("a=0:1:11"), (Values{"0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"}));
  EXPECT_EQ(values_of("a=10:-10:3"), (Values{"10", "0", "-10"}));
  EXPECT_EQ(values_of("a=100:1000:4"), (Values{"100", "400", "700", "1000"}));
}

TEST(Axis, OfALogarithmicRangeHasBothEndsAndDecades) {
  EXPECT_EQ(values_of("a=0.001:1000:7:log"), (Values{"0.001", "0.01", "0.1", "1", "10", "100", "1000"}));
  EXPECT_EQ(values_of("a=1000:10:3:log"), (Values{"1000", "100", "10"}));
}

TEST(Axis, EndPointsAreExactAndValuesBetweenThemInOrder) {
  for (const char* range :
       {"0.1:0.7:97", "0.1:0.7:97:log", "1e-300:1e300:97:log", "-1e300:1e300:97", "3:3.0000001:97"}) {
    const std::vector<double> values = numbers(std::string("a=") + range);
    const std::vector<std::string> parts = {std::string(range).substr(0, std::string(range).find(':'))};
    ASSERT_EQ(values.size(), 97u);
    EXPECT_EQ(values.front(), test::number_in(parts[0])) << range;
    for (std::size_t i = 1; i < values.size(); ++i) EXPECT_LT(values[i - 1], values[i]) << range << " " << i;
  }
  EXPECT_EQ(numbers("a=0.1:0.7:97").back(), 0.7);
  EXPECT_EQ(numbers("a=0.1:0.7:97:log").back(), 0.7);
  // The same value throughout stays the same: no rounding leaves the range.
  for (const double value : numbers("a=0.1:0.1:1000")) ASSERT_EQ(value, 0.1);
}

TEST(Axis, StepsAreEqualOrHaveEqualRatiosToRounding) {
  const std::vector<double> linear = numbers("a=0.3:7.1:60"), logarithmic = numbers("a=0.3:7.1:60:log");
  for (std::size_t i = 0; i < 60; ++i) {
    const double part = static_cast<double>(i) / 59.0;
    // Four roundings of at most half a unit of the largest value.
    EXPECT_NEAR(linear[i], 0.3 + (7.1 - 0.3) * part, 4 * 1.2e-16 * 7.1);
    // An error of some units of |log10| <= 1 is multiplied by ln 10 in the exponential function.
    EXPECT_NEAR(logarithmic[i] / (0.3 * std::pow(7.1 / 0.3, part)), 1.0, 16 * 2.3e-16);
  }
}

TEST(Axis, OfARangeKeepsNoneOfItsValues) {
  const Axis axis = parse_axis("a=0:999999:1000000");
  EXPECT_EQ(axis.size(), 1'000'000u);
  EXPECT_TRUE(axis.values.empty());
  EXPECT_EQ(axis.value(0), "0");
  EXPECT_EQ(axis.value(123'456), "123456");
  EXPECT_EQ(axis.value(999'999), "999999");
}

TEST(Axis, OfAListHasItsValuesInOrderAndNumbersInOneSpelling) {
  EXPECT_EQ(values_of("rendering.algorithm=mean,summation"), (Values{"mean", "summation"}));
  EXPECT_EQ(values_of("a=4e4,1.50,-0,true,null,7"), (Values{"40000", "1.5", "-0", "true", "null", "7"}));
  EXPECT_EQ(values_of("a=5"), Values{"5"});
}

TEST(Axis, RefusesWhatItCannotRead) {
  const std::string_view bad =
      "|=|a|a=|=1,2|a b=1,2|a,b=1,2|a=1,,2|a=,|a=1:2|a=1:2:3:4:5|a=1:2:1|a=1:2:0|a=1:2:-3|a=1:2:2.5|a=1:2:1000001|"
      "a=1:2:99999999999999999999|a=x:2:3|a=1::3|a=nan:1:3|a=1:inf:3|a=1e301:2:3|a=0:1:5:log|a=-1:1:5:log|"
      "a=1:2:5:lin|a=1:2:5:|a=\"x\",y|a=x\ny,z|a=x\r,z|a=\x7f";
  for (const std::string_view word : parts_of(bad, '|')) {
    const std::string text(word);
    const auto error = test::input_error_of([&] { parse_axis(text); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(std::string(error->what()).find("--vary \""), std::string::npos) << error->what();
    EXPECT_NE(std::string(error->what()).find("allowed: "), std::string::npos) << error->what();
  }
}

TEST(Axis, RefusesTooManyValuesInAFewWords) {
  std::string list = "a=0";
  for (std::size_t i = 0; i < kMostRuns; ++i) list += ",0";
  const auto error = test::input_error_of([&] { parse_axis(list); });
  ASSERT_TRUE(error);
  EXPECT_LT(std::string(error->what()).size(), 500u);
}

// ---- Samples

constexpr SamplingMethod kMethods[] = {SamplingMethod::latin_hypercube, SamplingMethod::sobol, SamplingMethod::random};

std::vector<UnitPoint> points_of(const Sampling& sampling, std::size_t axes) {
  const UnitSample sample(sampling, axes);
  std::vector<UnitPoint> points;
  for (std::size_t i = 0; i < sampling.count; ++i) points.push_back(sample.point(i));
  return points;
}

std::size_t stratum(double coordinate, std::size_t strata) {
  return static_cast<std::size_t>(coordinate * static_cast<double>(strata));
}

TEST(Sampling, HasItsPointsInTheUnitCubeAndMeansWhatItsSeedSays) {
  for (const SamplingMethod method : kMethods) {
    const auto points = points_of({method, 100, 1}, 5);
    ASSERT_EQ(points.size(), 100u);
    for (const UnitPoint& point : points) {
      ASSERT_EQ(point.size(), 5u);
      for (const double x : point) EXPECT_TRUE(x >= 0.0 && x < 1.0);
    }
    EXPECT_EQ(points_of({method, 100, 1}, 5), points);
    EXPECT_NE(points_of({method, 100, 2}, 5), points) << sampling_name(method);
    // An axis more leaves the others as they are, and no two are alike.
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(points_of({method, 100, 1}, 2)[i][1], points[i][1]);
    for (std::size_t a = 0; a < 5; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        EXPECT_TRUE(std::any_of(points.begin(), points.end(), [&](const UnitPoint& p) { return p[a] != p[b]; }));
      }
    }
  }
}

TEST(Sampling, OfALatinHypercubeHasOnePointInEveryStratumOfEachAxis) {
  for (const std::size_t count : {1u, 2u, 7u, 100u, 1000u}) {
    const auto points = points_of({SamplingMethod::latin_hypercube, count, 3}, 12);
    for (std::size_t axis = 0; axis < 12; ++axis) {
      std::set<std::size_t> strata;
      for (const UnitPoint& point : points) strata.insert(stratum(point[axis], count));
      EXPECT_EQ(strata.size(), count);
      EXPECT_EQ(*strata.rbegin(), count - 1);
    }
  }
}

TEST(Sampling, OfASobolSequenceIsBalancedInElementaryIntervals) {
  // Along each axis 2^k intervals of length 2^-k hold one of 2^k points each; in the plane of the first two axes, which
  // is a (0, k, 2)-net, so does every box of 2^-i x 2^(i-k).
  constexpr std::size_t k = 7, count = 1 << k;
  const auto points = points_of({SamplingMethod::sobol, count, 11}, kSobolAxes);
  for (std::size_t axis = 0; axis < kSobolAxes; ++axis) {
    std::set<std::size_t> intervals;
    for (const UnitPoint& point : points) intervals.insert(stratum(point[axis], count));
    EXPECT_EQ(intervals.size(), count) << axis;
  }
  for (std::size_t i = 0; i <= k; ++i) {
    std::set<std::pair<std::size_t, std::size_t>> boxes;
    for (const UnitPoint& point : points) {
      boxes.emplace(stratum(point[0], std::size_t{1} << i), stratum(point[1], std::size_t{1} << (k - i)));
    }
    EXPECT_EQ(boxes.size(), count) << i;
  }
}

/// scipy.stats.qmc.Sobol(d=53, scramble=False).random(1024) of scipy 1.10.1, times 1024.
constexpr std::size_t kAxes = 53;
struct SobolPoint {
  std::size_t index;
  std::uint32_t coordinates[kAxes];
};
constexpr SobolPoint kScipy[] = {
    {0, {}},
    {5, {896, 896, 128, 384, 896, 640, 896, 384, 384, 128, 384, 896, 896, 128, 896, 384, 896, 384,
         384, 640, 640, 640, 896, 384, 384, 384, 896, 128, 640, 640, 896, 640, 384, 384, 128, 128,
         128, 384, 896, 384, 384, 128, 640, 384, 384, 640, 128, 640, 640, 896, 640, 384, 640}},
    {777, {709, 959, 167, 281, 651, 365, 195, 781, 357, 331, 763, 713, 393, 485, 583, 527, 413, 885,
           379, 771, 243, 279, 969, 493, 353, 149, 61,  799, 65,  113, 555, 921, 115, 3,   825, 969,
           473, 359, 351, 367, 739, 273, 971, 411, 329, 155, 385, 33,  795, 975, 85,  37,  631}},
    {1000, {225,  99,  531, 693, 287, 929, 47,  921, 513, 71,   87,  261, 165,  393, 147, 379, 737, 353,
            1015, 743, 535, 563, 973, 553, 597, 929, 41,  1003, 61,  349, 151,  149, 303, 607, 821, 789,
            869,  851, 315, 491, 935, 261, 983, 719, 861, 95,   893, 941, 1023, 491, 361, 529, 771}}};

TEST(SobolAxis, IsThatOfScipy) {
  static_assert(kAxes == kSobolAxes);
  for (std::size_t axis = 0; axis < kSobolAxes; ++axis) {
    const SobolAxis sequence(axis);
    for (const SobolPoint& point : kScipy) {
      // The first 1024 points lie on multiples of 2^-10.
      EXPECT_EQ(sequence.at(static_cast<std::uint32_t>(point.index)), point.coordinates[axis] << 22)
          << "axis " << axis << ", point " << point.index;
    }
  }
}

TEST(Sampling, IsReadFromItsText) {
  const Sampling sampling = parse_sampling("sobol:64", 9);
  EXPECT_EQ(sampling.method, SamplingMethod::sobol);
  EXPECT_EQ(sampling.count, 64u);
  EXPECT_EQ(sampling.seed, 9u);
  for (const char* text : {"", "lhs", "lhs:", ":5", "lhs:0", "lhs:-1", "lhs:1.5", "lhs:1000001", "halton:5", "LHS:5",
                           "lhs:5:6", "lhs: 5"}) {
    const auto error = test::input_error_of([&] { parse_sampling(text, 1); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(std::string(error->what()).find("allowed: lhs:N, sobol:N or random:N"), std::string::npos);
  }
}

TEST(Sampling, OfTooManyAxesForSobolIsRefused) {
  EXPECT_TRUE(test::input_error_of([] { UnitSample({SamplingMethod::sobol, 4, 1}, kSobolAxes + 1); }));
  EXPECT_EQ(points_of({SamplingMethod::random, 4, 1}, kSobolAxes + 1).size(), 4u);
}

TEST(SampledAxis, IsARangeOrAList) {
  const Axis linear = parse_sampled_axis("a.b=1:3"), logarithmic = parse_sampled_axis("a=1:1e4:log");
  EXPECT_EQ(value_at(linear, 0.0), "1");
  EXPECT_EQ(value_at(linear, 0.25), "1.5");
  EXPECT_EQ(value_at(parse_sampled_axis("a=3:1"), 0.25), "2.5");
  EXPECT_EQ(value_at(logarithmic, 0.5), "100");
  const Axis list = parse_sampled_axis("a=x,y,z");
  EXPECT_EQ(value_at(list, 0.0) + value_at(list, 0.33) + value_at(list, 0.34) + value_at(list, 0.999), "xxyz");
}

TEST(SampledAxis, RefusesARangeWithACountAndAGridOneWithout) {
  for (const char* text : {"a=1:2:3", "a=1:2:3:log", "a=1:2:lin", "a=0:2:log", "a=1:", "a=1:2:log:log", "a=nan:1"}) {
    EXPECT_TRUE(test::input_error_of([&] { parse_sampled_axis(text); })) << text;
  }
  const auto sampled = test::input_error_of([] { parse_sampled_axis("a=1:2:3"); });
  EXPECT_NE(std::string(sampled->what()).find("beside --sample, which has its own; allowed: a:b"), std::string::npos);
  const auto grid = test::input_error_of([] { parse_axis("a=1:2"); });
  EXPECT_NE(std::string(grid->what()).find("a:b and a:b:log with --sample"), std::string::npos);
}

TEST(SweepPoints, OfALatinHypercubeGiveListedValuesEqualShares) {
  const SweepPoints points({parse_sampled_axis("a=x,y,z"), parse_sampled_axis("b=0:1")},
                           {SamplingMethod::latin_hypercube, 30, 1});
  ASSERT_EQ(points.size(), 30u);
  std::map<std::string, int> uses;
  for (std::size_t run = 0; run < points.size(); ++run) ++uses[points.values(run)[0]];
  EXPECT_EQ(uses, (std::map<std::string, int>{{"x", 10}, {"y", 10}, {"z", 10}}));
  EXPECT_EQ(points.overrides(3)[1], "b=" + points.values(3)[1]);
}

// ---- Grids and shards

TEST(Grid, HasAllCombinationsTheLastAxisFastest) {
  const SweepPoints grid({{"a", {"1", "2"}}, {"b", {"x"}}, {"c", {"p", "q", "r"}}});
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid.values(0), (Values{"1", "x", "p"}));
  EXPECT_EQ(grid.values(1), (Values{"1", "x", "q"}));
  EXPECT_EQ(grid.values(3), (Values{"2", "x", "p"}));
  EXPECT_EQ(grid.values(5), (Values{"2", "x", "r"}));
  EXPECT_EQ(grid.overrides(4), (Values{"a=2", "b=x", "c=q"}));
}

TEST(Grid, RefusesAFieldTwice) {
  EXPECT_TRUE(test::input_error_of([] { SweepPoints({{"a", {"1"}}, {"b", {"1"}}, {"a", {"2"}}}); }));
}

TEST(Grid, RefusesMoreRunsThanItMayHaveHoweverMany) {
  const Values thousand(1000, "0");
  EXPECT_EQ(SweepPoints({{"a", thousand}, {"b", thousand}}).size(), kMostRuns);
  EXPECT_TRUE(test::input_error_of([&] { SweepPoints({{"a", thousand}, {"b", thousand}, {"c", {"0", "1"}}}); }));
  // 1000^7 is beyond 64 bits.
  std::vector<Axis> axes;
  for (const char* path : {"a", "b", "c", "d", "e", "f", "g"}) axes.push_back({path, thousand});
  EXPECT_TRUE(test::input_error_of([&] { SweepPoints grid(axes); }));
}

TEST(Shard, IsReadFromItsText) {
  const Shard shard = parse_shard("2/7");
  EXPECT_EQ(shard.index, 2u);
  EXPECT_EQ(shard.count, 7u);
  EXPECT_EQ(shard_text(shard), "2/7");
  for (const char* text :
       {"", "/", "1", "1/", "/2", "2/2", "0/0", "-1/2", "1/2/3", "a/b", "0/1000001", "0 /2", "1.5/2"}) {
    EXPECT_TRUE(test::input_error_of([&] { parse_shard(text); })) << text;
  }
}

TEST(Shard, SharesOutEveryRunOnce) {
  for (const std::size_t runs : {0u, 1u, 6u, 7u, 100u}) {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 120u}) {
      std::size_t sum = 0;
      for (std::size_t index = 0; index < count; ++index) {
        const Shard shard{index, count};
        std::size_t own = 0;
        for (std::size_t run = index; run < runs; run += count) ++own;
        EXPECT_EQ(shard.size(runs), own) << index << "/" << count << " of " << runs;
        sum += own;
      }
      EXPECT_EQ(sum, runs);
    }
  }
}

}  // namespace
}  // namespace hapbench::sweep_points_test
