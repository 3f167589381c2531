// Built twice, with the vector type and with plain loops, so that both builds pass the same tests.
#include "sim/core/simd_check.hpp"

#include <gtest/gtest.h>

#include <bit>

namespace hapbench::simd {
namespace {

TEST(Simd, PaddedRoundsUpToWholePacksOfEight) {
  EXPECT_EQ(lanes, 8u);
  for (std::size_t n = 0; n < 20; ++n) EXPECT_EQ(padded(n), n == 0 ? 0u : n <= 8 ? 8u : n <= 16 ? 16u : 24u);
}

TEST(Simd, EveryOperationIsThatOfEachLaneWhateverTheNumbers) {
  EXPECT_EQ(first_wrong_operation(kOperations), "");
}

TEST(Simd, AWrongOperationIsFound) {
  const Operation wrong[] = {
      {"select", [](Pack a, const Pack& b) { return select(a <= b, b, a); }, kOperations[12].scalars}};
  EXPECT_EQ(first_wrong_operation(wrong), "select");
}

TEST(Simd, SumAddsLanesInItsStatedOrderAndProductsAreRoundedBefore) {
  // Use numbers whose sum depends on the order: any other order rounds differently.
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

TEST(Simd, LanesBetweenAreTheFirstUpToTheLast) {
  for (std::size_t from = 0; from < 10; ++from) {
    for (std::size_t to = 0; to < 20; ++to) {
      for (std::size_t i = 0; i < lanes; ++i)
        EXPECT_EQ((bits(lanes_between(from, to)) >> i & 1) != 0, from <= i && i < to);
    }
  }
}

}  // namespace
}  // namespace hapbench::simd
