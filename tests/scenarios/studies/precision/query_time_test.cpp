#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/input/input_error.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::query_time_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionQueryTime, AsksTheSameQuestionWithAndWithoutTheSearch) {
  const PrecisionResult result = kQueryTimeStudy.run(bundled("cone_in_cone"), quick());
  ASSERT_EQ(result.rows.size() % 2, 0u);
  const std::size_t levels = result.rows.size() / 2;
  for (std::size_t i = 0; i < levels; ++i) {
    SCOPED_TRACE(result.rows[i].setting);
    for (const char* column : {"pushed_m", "depth_max_mean_m", "contacts_mean"}) {
      EXPECT_EQ(value(result, i, column), value(result, levels + i, column)) << column;
    }
    EXPECT_LT(value(result, i, "points_tested_mean"), value(result, levels + i, "points_tested_mean"));
    if (i == 0) continue;
    EXPECT_GT(value(result, i, "depth_max_mean_m"), value(result, i - 1, "depth_max_mean_m"));
  }
  // Face against face, both leaning by 0.5 rad: the way into the cone, measured along the face's normal.
  for (std::size_t i = 0; i < levels; ++i) {
    EXPECT_NEAR(value(result, i, "depth_max_mean_m"), value(result, i, "pushed_m") * std::sin(0.5), 1e-6);
  }
}

TEST(PrecisionQueryTime, NeedsAStroke) {
  EXPECT_THROW(kQueryTimeStudy.run(bundled("rotate_in_hole"), quick()), InputError);
}

}  // namespace
}  // namespace hapbench::query_time_test
