#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "scenarios/input/fields.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/json_schema.hpp"
#include "scenarios/input/reader.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::fields_test {
namespace {

// Tests values at the limits of what is accepted. tests/data/golden/refused_scenarios.txt has the texts of errors;
// tests/scenarios/scene/scenario_schema_test.cpp tests that reader and schema agree about every field.

constexpr std::int64_t kMost = std::int64_t{1} << 53;

std::int64_t count_of(const Json& json) {
  std::int64_t count = -1;
  read_value(json, "/v", [&count](Fields& f) { f.integer(count, {1, kMost}); });
  return count;
}

TEST(Number, IsRefusedWhenNotFinite) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    double out = 1.0;
    const auto number = [&out](Fields& f) { f.number(out, {0.0, 10.0, "N"}); };
    EXPECT_TRUE(test::input_error_of([&] { read_value(Json(value), "/v", number); }));
    EXPECT_EQ(out, 1.0);
  }
}

TEST(Integer, MayBeWrittenAsAnyWholeNumber) {
  for (const char* text : {"1000", "1e3", "1000.0"}) EXPECT_EQ(count_of(Json::parse(text)), 1000);
  EXPECT_EQ(count_of(Json::parse("9007199254740992")), kMost);
}

TEST(Integer, IsRefusedAsAFractionAndBeyondItsBounds) {
  // 2^53 + 1 is not a double and would round to the bound 2^53.
  for (const char* text : {"1.5", "0", "-1", "9007199254740993", "9007199254740994", "1e300", "-1e300",
                           "18446744073709551615", "-9223372036854775808"}) {
    const auto error = test::input_error_of([text] { count_of(Json::parse(text)); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(error->problem().find("allowed: an integer 1 ... 9007199254740992"), std::string::npos);
  }
}

TEST(Text, IsMeasuredInCharactersNotBytes) {
  std::string text;
  const auto short_text = [&text](Fields& f) { f.text(text, 3); };
  for (const char* three : {"äöü", "😀😀😀"}) {
    read_value(three, "/v", short_text);
    EXPECT_EQ(text, three);
  }
  EXPECT_TRUE(test::input_error_of([&] { read_value("äöüß", "/v", short_text); }));
}

TEST(Fields, OfOneObjectExcludeEachOtherInOnePairAtMost) {
  const auto twice = [](Fields& f) {
    f.exactly_one_of("a", "b");
    f.exactly_one_of("c", "d");
  };
  EXPECT_THROW(guide_to([&](Fields& f) { f.fields(twice); }), std::logic_error);
}

}  // namespace
}  // namespace hapbench::fields_test
