#include "scenarios/input/input_error.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/scenarios/support/errors.hpp"

namespace hapbench::input_error_test {
namespace {

const std::vector<std::string> kNames = {"stiffness_N_per_m", "damping_ratio", "mass_kg", "mu_s_N_s_per_m", "mean"};

TEST(InputError, SaysPlaceThenProblem) {
  const InputError error(InputError::Kind::shape, "/time/steps", "got 0; allowed: more");
  EXPECT_STREQ(error.what(), "/time/steps: got 0; allowed: more");
  EXPECT_EQ(error.place(), "/time/steps");
  EXPECT_EQ(error.problem(), "got 0; allowed: more");
  EXPECT_EQ(error.kind(), InputError::Kind::shape);
}

TEST(InputError, WithoutAPlaceSaysOnlyTheProblem) {
  EXPECT_STREQ(InputError("nothing is called so").what(), "nothing is called so");
}

TEST(InputError, IsOneLineWhateverNamesAndValuesHold) {
  const InputError error(InputError::Kind::relation, "a\nb.csv", std::string("got \"\r\x1b[31m\0\x7f\"", 14));
  EXPECT_STREQ(error.what(), "a?b.csv: got \"??[31m??\"");
}

TEST(NearestName, ForgivesOneSlipOfTheFingers) {
  for (const char* slip : {"stiffnes_N_per_m", "stiffness_N_per_mm", "stiffness_n_per_m", "stifness_N_per_m"}) {
    EXPECT_EQ(nearest_name(slip, kNames), "stiffness_N_per_m") << slip;
  }
  EXPECT_EQ(nearest_name("maen", kNames), "mean") << "neighbours swapped";
  EXPECT_EQ(nearest_name("moon", kNames), "") << "two letters of four: could mean anything";
  EXPECT_EQ(nearest_name("mesn", kNames), "mean");
}

TEST(NearestName, KnowsANameByItsBeginningOrAPart) {
  EXPECT_EQ(nearest_name("stiffness", kNames), "stiffness_N_per_m");
  EXPECT_EQ(nearest_name("ratio", kNames), "damping_ratio");
}

TEST(NearestName, KnowsAMisspeltNameWithoutItsUnit) {
  EXPECT_EQ(nearest_name("stifness", kNames), "stiffness_N_per_m");
  EXPECT_EQ(nearest_name("dampin", kNames), "damping_ratio");
}

TEST(NearestName, SuggestsNothingForSomethingElse) {
  EXPECT_EQ(nearest_name("colour", kNames), "");
  EXPECT_EQ(nearest_name("", kNames), "");
  EXPECT_EQ(nearest_name("x", kNames), "");
  EXPECT_EQ(nearest_name("mean", {}), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'm'), kNames), "");
}

TEST(NearestName, PrefersTheCloserOfTwo) {
  const std::vector<std::string> names = {"min_depth", "max_depth", "max_death"};
  EXPECT_EQ(nearest_name("max_depht", names), "max_depth");
  EXPECT_EQ(nearest_name("max_deaht", names), "max_death");
}

TEST(NearestNameHint, IsAClauseOrNothing) {
  EXPECT_EQ(nearest_name_hint("mas_kg", kNames), "; nearest valid name: \"mass_kg\"");
  EXPECT_EQ(nearest_name_hint("colour", kNames), "");
}

TEST(RequireValidName, RefusesOtherNamesAndSaysWhichAreAllowed) {
  EXPECT_NO_THROW(require_valid_name("--only: got", kNames[0], kNames));
  try {
    require_valid_name("--only: got", "mas_kg", kNames);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "--only: got \"mas_kg\"; allowed: " + quoted_list(kNames) + "; nearest valid name: \"mass_kg\"");
  }
}

TEST(FailIn, NamesTheFileAndItsLine) {
  EXPECT_STREQ(test::input_error_of([] { fail_in_file("a.csv", "is odd"); })->what(), "a.csv: is odd");
  EXPECT_STREQ(test::input_error_of([] { fail_in_line("a.csv", 3, "is odd"); })->what(), "a.csv, line 3: is odd");
}

TEST(QuotedList, NamesAllOrSaysNothing) {
  EXPECT_EQ(quoted_list(std::vector<std::string>{"a", "b"}), "\"a\", \"b\"");
  EXPECT_EQ(quoted_list({}), "nothing");
}

}  // namespace
}  // namespace hapbench::input_error_test
