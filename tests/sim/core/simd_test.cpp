// Built twice, against the vector type and against the plain loops, so that both obey the same rules.
#include "sim/core/simd.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

#include "sim/core/aligned.hpp"

namespace hapbench::simd {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Pack pack(const AlignedDoubles& values) {
  return load(values.data());
}

AlignedDoubles values(const Pack& a) {
  AlignedDoubles v(lanes);
  store(a, v.data());
  return v;
}

const AlignedDoubles kA = {1.0, -2.0, 0.0, -0.0, 3.5, 1e300, -1e-300, 7.0};
const AlignedDoubles kB = {2.0, -3.0, 0.0, 5.0, 3.5, -1e300, 1e-300, 0.1};

TEST(Simd, EightLanes) {
  EXPECT_EQ(lanes, 8u);
}

TEST(Simd, PaddedRoundsUpToWholePacks) {
  EXPECT_EQ(padded(0), 0u);
  EXPECT_EQ(padded(1), 8u);
  EXPECT_EQ(padded(8), 8u);
  EXPECT_EQ(padded(9), 16u);
}

TEST(Simd, LoadThenStoreIsTheIdentity) {
  EXPECT_EQ(values(pack(kA)), kA);
}

TEST(Simd, OneNumberFillsAllLanes) {
  EXPECT_EQ(values(Pack(2.5)), AlignedDoubles(lanes, 2.5));
}

TEST(Simd, ArithmeticIsThatOfEachLane) {
  const Pack a = pack(kA), b = pack(kB);
  for (std::size_t i = 0; i < lanes; ++i) {
    EXPECT_EQ(values(a + b)[i], kA[i] + kB[i]);
    EXPECT_EQ(values(a - b)[i], kA[i] - kB[i]);
    EXPECT_EQ(values(a * b)[i], kA[i] * kB[i]);
    EXPECT_EQ(values(b / Pack(3.0))[i], kB[i] / 3.0);
    EXPECT_EQ(values(-a)[i], -kA[i]);
    EXPECT_EQ(values(abs(a))[i], std::abs(kA[i]));
    EXPECT_EQ(values(sqrt(abs(b)))[i], std::sqrt(std::abs(kB[i])));
  }
}

TEST(Simd, ProductsAreRoundedBeforeTheyAreAdded) {
  // With a fused multiply-add the square of 1 + 2^-30 would keep its last bit and the sum would be 2^-60.
  const double x = 1.0 + 0x1.0p-30;
  const Pack a(x);
  EXPECT_EQ(values(a * a + Pack(-(1.0 + 0x1.0p-29)))[0], 0.0);
}

TEST(Simd, ComparisonsAreThoseOfEachLaneAndFalseForNaN) {
  AlignedDoubles with_nan = kA;
  with_nan[2] = kNaN;
  const Pack a = pack(with_nan), b = pack(kB);
  for (std::size_t i = 0; i < lanes; ++i) {
    EXPECT_EQ(lane(a < b, i), with_nan[i] < kB[i]);
    EXPECT_EQ(lane(a <= b, i), with_nan[i] <= kB[i]);
    EXPECT_EQ(lane(a > b, i), with_nan[i] > kB[i]);
    EXPECT_EQ(lane(a >= b, i), with_nan[i] >= kB[i]);
    EXPECT_EQ(lane(a < b && a > b, i), false);
    EXPECT_EQ(lane(a < b || a >= b, i), i != 2);
    EXPECT_EQ(lane(!(a < b), i), !(with_nan[i] < kB[i]));
  }
}

TEST(Simd, AnyIsTrueForASingleLane) {
  for (std::size_t i = 0; i < lanes; ++i) {
    AlignedDoubles v(lanes, 0.0);
    v[i] = 1.0;
    EXPECT_TRUE(any(pack(v) > Pack(0.5)));
  }
  EXPECT_FALSE(any(Pack(0.0) > Pack(0.5)));
}

/// The mask of the lanes whose bits are set.
Mask mask_of(unsigned bits) {
  AlignedDoubles ones(lanes);
  for (std::size_t i = 0; i < lanes; ++i) ones[i] = (bits >> i) % 2;
  return pack(ones) > Pack(0.0);
}

TEST(Simd, StoreSelectedClosesTheGapsOfEveryMask) {
  alignas(64) const std::uint32_t numbers[lanes] = {10, 11, 12, 13, 14, 15, 16, 17};
  for (unsigned mask = 0; mask < 256; ++mask) {
    std::vector<double> expected;
    std::vector<std::uint32_t> expected_numbers;
    for (std::size_t i = 0; i < lanes; ++i) {
      if ((mask >> i) % 2 == 0) continue;
      expected.push_back(kA[i]);
      expected_numbers.push_back(numbers[i]);
    }
    const std::uint8_t selected = bits(mask_of(mask));
    ASSERT_EQ(selected, mask);
    const std::size_t n = expected.size();
    double to[lanes];
    std::uint32_t to_numbers[lanes];
    store_selected(selected, kA.data(), to);
    store_selected(selected, numbers, to_numbers);
    EXPECT_TRUE(std::equal(to, to + n, expected.begin())) << mask;
    EXPECT_TRUE(std::equal(to_numbers, to_numbers + n, expected_numbers.begin())) << mask;
    if (mask == 0) continue;
    const std::size_t lowest = first(mask_of(mask));
    EXPECT_TRUE((mask >> lowest) % 2 == 1 && mask % (1u << lowest) == 0) << mask;
  }
}

TEST(Simd, LanesBetweenAreTheFirstUpToTheLast) {
  for (std::size_t from = 0; from < 10; ++from) {
    for (std::size_t to = 0; to < 20; ++to) {
      for (std::size_t i = 0; i < lanes; ++i) EXPECT_EQ(lane(lanes_between(from, to), i), from <= i && i < to);
    }
  }
}

TEST(Simd, SelectTakesYesWhereTheMaskIsSet) {
  const Pack a = pack(kA), b = pack(kB);
  const AlignedDoubles selected = values(select(a < b, a, b));
  for (std::size_t i = 0; i < lanes; ++i) EXPECT_EQ(selected[i], kA[i] < kB[i] ? kA[i] : kB[i]);
}

TEST(Simd, MinAndMaxKeepTheFirstArgumentWhenTheSecondIsNaN) {
  EXPECT_EQ(values(min(Pack(1.0), Pack(kNaN)))[0], 1.0);
  EXPECT_EQ(values(max(Pack(1.0), Pack(kNaN)))[0], 1.0);
  EXPECT_EQ(values(min(Pack(1.0), Pack(-kInf)))[0], -kInf);
  EXPECT_EQ(values(max(Pack(1.0), Pack(kInf)))[0], kInf);
}

TEST(Simd, MinAndMaxAreTheFirstArgumentUnlessTheSecondIsBeyond) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  const AlignedDoubles special = {0.0, -0.0, 1.0, -1.0, kInf, -kInf, kNaN, 1e-310};
  for (const double a : special) {
    const AlignedDoubles least = values(min(Pack(a), pack(special))), most = values(max(Pack(a), pack(special)));
    for (std::size_t i = 0; i < lanes; ++i) {
      const double b = special[i];
      EXPECT_TRUE(same(least[i], b < a ? b : a)) << a << " " << b;
      EXPECT_TRUE(same(most[i], a < b ? b : a)) << a << " " << b;
    }
  }
}

TEST(Simd, MinLaneAndMaxLaneFindEveryLane) {
  for (std::size_t i = 0; i < lanes; ++i) {
    AlignedDoubles v(lanes, 1.0);
    v[i] = -2.0;
    EXPECT_EQ(min_lane(pack(v)), -2.0);
    v[i] = 3.0;
    EXPECT_EQ(max_lane(pack(v)), 3.0);
  }
}

TEST(Simd, SumAddsLanesInItsStatedOrder) {
  // Numbers whose sum depends on the order: any other order of these rounds differently.
  const AlignedDoubles v = {1e16, 1.0, -1e16, 3.0, 1.0, 1e-3, 7.0, 0.1};
  const double stated = ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
  double from_left = 0.0;
  for (const double x : v) from_left += x;
  ASSERT_NE(stated, from_left);
  EXPECT_EQ(sum(pack(v)), stated);
}

}  // namespace
}  // namespace hapbench::simd
