#include <gtest/gtest.h>

#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::reduction_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionReduction, ExactShapingWithoutReductionIsTheReference) {
  const PrecisionResult result = kReductionStudy.run(bundled("task2_rotate_signed_distance"), quick());
  const std::size_t exact_off = result.rows.size() - 1;
  EXPECT_EQ(result.rows[exact_off].setting, "exact_shaping off");
  EXPECT_EQ(value(result, exact_off, "force_error_relative"), 0.0);
  for (std::size_t row = 0; row < exact_off; ++row) {
    EXPECT_GT(value(result, row, "force_error_relative"), 0.0) << result.rows[row].setting;
    EXPECT_LE(value(result, row, "kept_mean"), value(result, exact_off, "kept_mean"));
  }
}

}  // namespace
}  // namespace hapbench::reduction_test
