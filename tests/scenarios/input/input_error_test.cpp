#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::input_error_test {
namespace {

TEST(InputError, IsOneLineWhateverNamesAndValuesHold) {
  const InputError error(InputError::Kind::relation, "a\nb.csv", std::string("got \"\r\x1b[31m\0\x7f\"", 14));
  EXPECT_STREQ(error.what(), "a?b.csv: got \"??[31m??\"");
}

TEST(ErrorLocation, NamesWhatIsThere) {
  EXPECT_EQ(ErrorLocation{}.text(), "");
  EXPECT_EQ((ErrorLocation{.pointer = "/time"}.text()), "/time");
  EXPECT_EQ((ErrorLocation{.file = "a.json", .pointer = "/time"}.text()), "a.json: /time");
  EXPECT_EQ((ErrorLocation{.outer = {"a.json"}, .file = "b.obj", .line = 3}.text()), "a.json: b.obj, line 3");
  EXPECT_EQ((ErrorLocation{.file = "stroke.csv", .entry = "sample 2"}.text()), "stroke.csv, sample 2");
  EXPECT_EQ((ErrorLocation{.option = "--device touch", .file = "a.json", .pointer = "/time"}.text()),
            "--device touch: a.json: /time");
}

TEST(InputError, AboutAnOptionHasItAsDataAndBeginsWithIt) {
  const auto error = test::input_error_of([] { fail_in_option("--between", "got \"2:1\""); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "--between: got \"2:1\"");
  EXPECT_EQ(error->location().about_options, std::vector<std::string>{"--between"});
  EXPECT_EQ(error->location_text(), "") << "a file in front of the error stands before the option";
}

TEST(InputError, KeepsItsLocationAsDataAmongSeveral) {
  const InputError first(InputError::Kind::relation, ErrorLocation{.file = "a.json", .pointer = "/seed"}, "got -1");
  const InputError second(InputError::Kind::shape, "/time", "missing");
  const InputError both = InputError::all({first, second});
  EXPECT_EQ(both.location().pointer, "/time") << "what a schema refuses comes first";
  ASSERT_EQ(both.faults().size(), 2u);
  EXPECT_EQ(both.faults()[1].location().file, "a.json");
  EXPECT_STREQ(both.faults()[1].what(), "a.json: /seed: got -1");
}

}  // namespace
}  // namespace hapbench::input_error_test
