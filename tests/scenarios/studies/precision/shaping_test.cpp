#include <gtest/gtest.h>

#include <cmath>

#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::shaping_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionShaping, IterationsApproachTheExactTensor) {
  const PrecisionResult result = kShapingStudy.run(bundled("task2_rotate_signed_distance"), quick());
  double last = INFINITY;
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    const double error = value(result, row, "tensor_error_rms");
    EXPECT_LT(error, last) << result.rows[row].setting;
    last = error;
  }
  EXPECT_EQ(last, 0.0) << "the exact row is its own reference";
}

}  // namespace
}  // namespace hapbench::shaping_test
