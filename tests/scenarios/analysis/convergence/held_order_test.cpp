#include "scenarios/analysis/convergence/held_order.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace hapbench::held_order_test {
namespace {

TEST(HeldOrder, SaysWhatHoldsAndOfWhatNoErrorIsKnown) {
  const auto says = [](const std::vector<NumberWithError>& numbers) {
    const std::vector<std::string> names = {"a", "b", "c", "d"};
    return held_text(numbers, names);
  };
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}}), "the order holds: b < a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 1.0}}), "no order holds: b ~ a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {2.1, 0.1}, {9.0, std::nullopt}}),
            "the order holds in part: b < a ~ c; no error is known of d");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {1.5, 7.0}}), "the order holds in part: b < a; too uncertain for a place: c");
  EXPECT_EQ(says({{1.0, 0.1}, {1.5, 0.6}, {3.0, 0.1}}), "the order holds in part: a ~ b < c");
  EXPECT_EQ(says({{1.0, 0.0}, {1.0 + 1e-12, 0.0}}), "no order holds: a ~ b") << "rounding is no difference";
  EXPECT_EQ(says({{std::nullopt, 0.1}, {1.0, 0.1}}), "there is nothing to compare");
}

}  // namespace
}  // namespace hapbench::held_order_test
