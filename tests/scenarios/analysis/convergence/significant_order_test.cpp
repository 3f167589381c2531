#include "scenarios/analysis/convergence/significant_order.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace hapbench::significant_order_test {
namespace {

TEST(SignificantOrder, ReportsTheOrderAndWhatHasNoKnownError) {
  const auto says = [](const std::vector<NumberWithError>& numbers) {
    const std::vector<std::string> names = {"a", "b", "c", "d"};
    return significant_order_text(numbers, names);
  };
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}}), "significant order: b < a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 1.0}}), "no significant order: b ~ a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {2.1, 0.1}, {9.0, std::nullopt}}),
            "partly significant order: b < a ~ c; no error estimate for: d");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {1.5, 7.0}}), "partly significant order: b < a; error too large to rank: c");
  EXPECT_EQ(says({{1.0, 0.1}, {1.5, 0.6}, {3.0, 0.1}}), "partly significant order: a ~ b < c");
  EXPECT_EQ(says({{1.0, 0.0}, {1.0 + 1e-12, 0.0}}), "no significant order: a ~ b") << "rounding is no difference";
  EXPECT_EQ(says({{std::nullopt, 0.1}, {1.0, 0.1}}), "nothing to compare");
}

}  // namespace
}  // namespace hapbench::significant_order_test
