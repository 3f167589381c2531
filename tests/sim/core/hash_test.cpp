#include "sim/core/hash.hpp"

#include <gtest/gtest.h>

namespace hapbench::hash_test {
namespace {

// Values of the reference implementation (draft-eastlake-fnv, test vectors for FNV-1a, 64 bits).
TEST(Hash, OfTextEqualsPublishedVectorsOfFnv1a) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325u);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8u);
}

TEST(Hash, OfTextInPiecesEqualsHashOfTheWhole) {
  Hash64 hash;
  hash.bytes("foo");
  hash.bytes("bar");
  EXPECT_EQ(hash.value(), hash_of("foobar"));
}

std::uint64_t hash_of_reals(double a, double b) {
  Hash64 hash;
  hash.real(a);
  hash.real(b);
  return hash.value();
}

TEST(Hash, TellsZeroFromMinusZero) {
  EXPECT_NE(hash_of_reals(0.0, 1.0), hash_of_reals(-0.0, 1.0));
}

TEST(Hash, TellsTwoFlippedSignsFromNone) {
  EXPECT_NE(hash_of_reals(1.5, 2.5), hash_of_reals(-1.5, -2.5));
}

TEST(Hash, DependsOnTheOrder) {
  EXPECT_NE(hash_of_reals(1.0, 2.0), hash_of_reals(2.0, 1.0));
}

TEST(Hash, TextHasSixteenHexadecimalDigitsLeadingZerosIncluded) {
  EXPECT_EQ(hash_text(0x00f1e2d3c4b5a697u), "00f1e2d3c4b5a697");
  EXPECT_EQ(hash_text(0), "0000000000000000");
}

}  // namespace
}  // namespace hapbench::hash_test
