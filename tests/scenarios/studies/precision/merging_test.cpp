#include <gtest/gtest.h>

#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::merging_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionMerging, DependsOnTheOrderOfTheContactsOnlyWhereTheyAreReduced) {
  const PrecisionResult result = kMergingStudy.run(bundled("task2_rotate_signed_distance"), quick());
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    const std::string& setting = result.rows[row].setting;
    const bool reduced = setting.find("reduced") != std::string::npos;
    const double spread = value(result, row, "order_spread_relative");
    if (reduced) {
      EXPECT_GT(spread, 0.1) << setting;
      EXPECT_LT(value(result, row, "kept_mean"), value(result, row, "contacts_mean")) << setting;
    } else {
      // Sums of up to a thousand contacts in another order; exact_shaping knows weights to rounding over epsilon.
      EXPECT_LE(spread, 1e-9) << setting;
      EXPECT_EQ(value(result, row, "kept_mean"), value(result, row, "contacts_mean")) << setting;
    }
  }
  // At every spacing merging is nearer to the exact force than reducing.
  for (std::size_t row = 4; row < result.rows.size(); row += 5) {
    ASSERT_EQ(result.rows[row].setting.find("merged_shaping"), 0u);
    EXPECT_LT(value(result, row, "force_error_relative"), value(result, row - 3, "force_error_relative"));
    EXPECT_LT(value(result, row, "force_error_relative"), value(result, row - 1, "force_error_relative"));
  }
}

}  // namespace
}  // namespace hapbench::merging_test
