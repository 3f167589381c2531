#include "results/summary/outcome_names.hpp"

#include <gtest/gtest.h>

namespace hapbench::outcome_names_test {
namespace {

TEST(OutcomeNames, AreThoseOfTheScenarioFormat) {
  EXPECT_EQ(outcome_name(Outcome::completes), "completes");
  EXPECT_EQ(outcome_name(Outcome::leaves_hole), "leaves_hole");
  EXPECT_EQ(outcome_name(Outcome::tool_horizontal), "tool_horizontal");
  EXPECT_EQ(outcome_name(Outcome::diverges), "diverges");
}

TEST(OutcomeNames, LeadBackToTheirOutcomes) {
  ASSERT_EQ(outcome_names().size(), 7u);
  for (const std::string_view name : outcome_names()) {
    const auto outcome = outcome_named(name);
    ASSERT_TRUE(outcome) << name;
    EXPECT_EQ(outcome_name(*outcome), name);
  }
}

TEST(OutcomeNames, DoNotIncludeOtherWords) {
  for (const char* name : {"", "complete", "Completes", "completes "}) EXPECT_FALSE(outcome_named(name)) << name;
}

}  // namespace
}  // namespace hapbench::outcome_names_test
