// Built twice, with the vector type and with the plain loops, so that both obey the same rules. A compiler whose vector
// type computes anything else fails here first.
#include "sim/core/simd.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "sim/core/aligned.hpp"
#include "sim/core/random.hpp"

namespace hapbench::simd {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
const AlignedDoubles kSpecial = {0.0, -0.0, 1.0, -1.0, kInf, -kInf, kNaN, 1e-310};

AlignedDoubles values(const Pack& a) {
  AlignedDoubles v(lanes);
  store(a, v.data());
  return v;
}

/// Bit for bit, except that a NaN is a NaN: neither sign nor payload of a computed one is defined.
bool same(double x, double y) {
  return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || (x != x && y != y);
}

/// Eight numbers of all sizes and signs, every other one special.
AlignedDoubles random_numbers(Random& random) {
  AlignedDoubles numbers(lanes);
  for (double& number : numbers) {
    const double size = std::pow(10.0, random.uniform(-5.0, 5.0));
    number = random.below(2) == 0 ? kSpecial[random.below(lanes)] : random.uniform(-size, size);
  }
  return numbers;
}

TEST(Simd, PaddedRoundsUpToWholePacksOfEight) {
  EXPECT_EQ(lanes, 8u);
  for (std::size_t n = 0; n < 20; ++n) EXPECT_EQ(padded(n), n == 0 ? 0u : n <= 8 ? 8u : n <= 16 ? 16u : 24u);
}

struct Operation {
  const char* name;
  Pack (*packs)(Pack a, const Pack& b);
  double (*scalars)(double a, double b);
};
const Operation kOperations[] = {
    {"load", [](Pack a, const Pack&) { return a; }, [](double a, double) { return a; }},
    {"broadcast", [](Pack, const Pack&) { return Pack(2.5); }, [](double, double) { return 2.5; }},
    {"+", [](Pack a, const Pack& b) { return a + b; }, [](double a, double b) { return a + b; }},
    {"+=", [](Pack a, const Pack& b) { return a += b, a; }, [](double a, double b) { return a + b; }},
    {"-", [](Pack a, const Pack& b) { return a - b; }, [](double a, double b) { return a - b; }},
    {"*", [](Pack a, const Pack& b) { return a * b; }, [](double a, double b) { return a * b; }},
    {"/", [](Pack a, const Pack& b) { return a / b; }, [](double a, double b) { return a / b; }},
    {"negate", [](Pack a, const Pack&) { return -a; }, [](double a, double) { return -a; }},
    {"abs", [](Pack a, const Pack&) { return abs(a); }, [](double a, double) { return a < 0.0 ? -a : a; }},
    {"sqrt", [](Pack a, const Pack&) { return sqrt(a); }, [](double a, double) { return std::sqrt(a); }},
    {"min", [](Pack a, const Pack& b) { return min(a, b); }, [](double a, double b) { return b < a ? b : a; }},
    {"max", [](Pack a, const Pack& b) { return max(a, b); }, [](double a, double b) { return a < b ? b : a; }},
    {"select", [](Pack a, const Pack& b) { return select(a < b, a, b); },
     [](double a, double b) { return a < b ? a : b; }},
};

struct Comparison {
  const char* name;
  Mask (*packs)(const Pack& a, const Pack& b);
  bool (*scalars)(double a, double b);
};
const Comparison kComparisons[] = {
    {"<", [](const Pack& a, const Pack& b) { return a < b; }, [](double a, double b) { return a < b; }},
    {"<=", [](const Pack& a, const Pack& b) { return a <= b; }, [](double a, double b) { return a <= b; }},
    {">", [](const Pack& a, const Pack& b) { return a > b; }, [](double a, double b) { return a > b; }},
    {">=", [](const Pack& a, const Pack& b) { return a >= b; }, [](double a, double b) { return a >= b; }},
    {"!", [](const Pack& a, const Pack& b) { return !(a < b); }, [](double a, double b) { return !(a < b); }},
    {"&&", [](const Pack& a, const Pack& b) { return a <= b && a >= b; }, [](double a, double b) { return a == b; }},
    {"||", [](const Pack& a, const Pack& b) { return a < b || a >= Pack(1.0); },
     [](double a, double b) { return a < b || a >= 1.0; }},
};

TEST(Simd, EveryOperationIsThatOfEachLaneWhateverTheNumbers) {
  Random random(1);
  for (int i = 0; i < 10'000; ++i) {
    const AlignedDoubles a = random_numbers(random), b = random_numbers(random);
    const Pack pa = load(a.data()), pb = load(b.data());
    for (const Operation& operation : kOperations) {
      const AlignedDoubles result = values(operation.packs(pa, pb));
      for (std::size_t k = 0; k < lanes; ++k) {
        const double expected = operation.scalars(a[k], b[k]);
        ASSERT_TRUE(same(result[k], expected)) << a[k] << " " << operation.name << " " << b[k] << ": " << result[k];
      }
    }
    for (const Comparison& comparison : kComparisons) {
      const Mask mask = comparison.packs(pa, pb);
      unsigned expected = 0;
      for (std::size_t k = 0; k < lanes; ++k) {
        expected |= static_cast<unsigned>(comparison.scalars(a[k], b[k])) << k;
        ASSERT_EQ(lane(mask, k), (expected >> k & 1u) != 0) << a[k] << " " << comparison.name << " " << b[k];
      }
      ASSERT_EQ(bits(mask), expected) << comparison.name;
      ASSERT_EQ(any(mask), expected != 0) << comparison.name;
    }
    double least = a[0], most = a[0];
    for (const double x : a) {
      least = x < least ? x : least;
      most = most < x ? x : most;
    }
    ASSERT_TRUE(same(min_lane(pa), least));
    ASSERT_TRUE(same(max_lane(pa), most));
    ASSERT_TRUE(same(sum(pa), ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]))));
  }
}

TEST(Simd, SumAddsLanesInItsStatedOrderAndProductsAreRoundedBefore) {
  // Numbers whose sum depends on the order: any other order of these rounds differently.
  const AlignedDoubles v = {1e16, 1.0, -1e16, 3.0, 1.0, 1e-3, 7.0, 0.1};
  const double stated = ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
  double from_left = 0.0;
  for (const double x : v) from_left += x;
  ASSERT_NE(stated, from_left);
  EXPECT_EQ(sum(load(v.data())), stated);
  // With a fused multiply-add the square of 1 + 2^-30 would keep its last bit and the sum would be 2^-60.
  const Pack a(1.0 + 0x1.0p-30);
  EXPECT_EQ(values(a * a + Pack(-(1.0 + 0x1.0p-29)))[0], 0.0);
}

TEST(Simd, StoreSelectedClosesTheGapsOfEveryMask) {
  const AlignedDoubles from = {1.0, -2.0, 0.0, -0.0, 3.5, 1e300, -1e-300, 7.0};
  alignas(64) const std::uint32_t numbers[lanes] = {10, 11, 12, 13, 14, 15, 16, 17};
  for (unsigned mask = 0; mask < 256; ++mask) {
    AlignedDoubles ones(lanes);
    for (std::size_t i = 0; i < lanes; ++i) ones[i] = (mask >> i) % 2;
    const Mask selected = load(ones.data()) > Pack(0.0);
    ASSERT_EQ(bits(selected), mask);
    double to[lanes];
    std::uint32_t to_numbers[lanes];
    store_selected(bits(selected), from.data(), to);
    store_selected(bits(selected), numbers, to_numbers);
    std::size_t n = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
      if ((mask >> i) % 2 == 0) continue;
      if (n == 0) {
        EXPECT_EQ(first(selected), i) << mask;
      }
      EXPECT_TRUE(same(to[n], from[i]) && to_numbers[n] == numbers[i]) << mask;
      ++n;
    }
  }
}

TEST(Simd, LanesBetweenAreTheFirstUpToTheLast) {
  for (std::size_t from = 0; from < 10; ++from) {
    for (std::size_t to = 0; to < 20; ++to) {
      for (std::size_t i = 0; i < lanes; ++i) EXPECT_EQ(lane(lanes_between(from, to), i), from <= i && i < to);
    }
  }
}

}  // namespace
}  // namespace hapbench::simd
