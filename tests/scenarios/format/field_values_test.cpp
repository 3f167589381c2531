#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/format/fields.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/format/writer.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Values at the edge of what is read, and how messages name a place (JSON pointer, RFC 6901) and show a value. What
/// refusals say is in tests/data/golden/refused_scenarios.txt; that reader and schema agree about every field, in
/// schema_agreement_test.cpp.
namespace hapbench::field_values_test {
namespace {

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
  // 2^53 + 1 has no double of its own and would round to the bound 2^53.
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

TEST(Object, HasNoMoreFaultsReportedThanAnybodyReads) {
  Json json = test::minimal_scenario("plane");
  for (std::size_t i = 0; i < 10 * kMostFaults; ++i) json["key" + std::to_string(i)] = 0;
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->faults().size(), kMostFaults);
}

TEST(Pointer, EscapesTildeAndSlashAsRfc6901Says) {
  // The examples of RFC 6901, section 5.
  EXPECT_EQ(member("", "a/b"), "/a~1b");
  EXPECT_EQ(member("", "m~n"), "/m~0n");
  EXPECT_EQ(member("", "~1"), "/~01");
  EXPECT_EQ(member("", ""), "/");
  EXPECT_EQ(element(member("", "foo"), 0), "/foo/0");
}

TEST(Pointer, IsOneShortLineWhateverTheKey) {
  EXPECT_EQ(member("", std::string(1'000'000, 'k')), "/" + std::string(200, 'k'));
  EXPECT_EQ(member("", "a\nb\tc\x1b"), "/a?b?c?");
}

TEST(ShownValue, IsShortAndInAscii) {
  EXPECT_EQ(shown(Json(std::string(1000, 'x'))), "\"" + std::string(79, 'x') + "...");
  EXPECT_EQ(shown(Json(std::vector<int>(1'000'000))), "a list of 1000000 entries");
  for (const char* bytes : {"\xc3\xa4", "\xff\xfe", "\xed\xa0\x80", "\xe2\x80\xa8"}) {
    const std::string text = shown(Json(bytes));
    EXPECT_EQ(text.find_first_not_of("\"\\u0123456789abcdef"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace hapbench::field_values_test
