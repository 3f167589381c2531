#include "sim/core/bisection.hpp"

#include <gtest/gtest.h>

namespace hapbench::bisection_test {
namespace {

TEST(LargestStable, FindsTheEdgeFromBothSides) {
  for (const double edge : {3e-7, 0.02, 1.0, 433731.0, 7e12}) {
    for (const double start : {1e-3, 1.0, 1e5}) {
      const double found = largest_stable(start, 1e-4, [&](double value) { return value <= edge; });
      EXPECT_LE(found, edge);
      EXPECT_GE(found, edge / (1.0 + 1e-4) * (1.0 - 1e-12));
    }
  }
}

TEST(LargestStable, SaysWhenThereIsNoEdge) {
  EXPECT_EQ(largest_stable(1.0, 1e-4, [](double) { return false; }), 0.0);
  EXPECT_TRUE(std::isinf(largest_stable(1.0, 1e-4, [](double) { return true; })));
}

}  // namespace
}  // namespace hapbench::bisection_test
