#include "scenarios/description/values.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/scenarios/support/errors.hpp"

namespace hapbench {
namespace {

/// What the codec makes of a JSON text.
template <class T>
T value_of(const CodecPtr<T>& codec, const std::string& text, T value = {}) {
  codec->read(Json::parse(text), "/v", value);
  return value;
}

/// The message with which the codec refuses a JSON text.
template <class T>
std::string refusal_of(const CodecPtr<T>& codec, const std::string& text) {
  SCOPED_TRACE(text);
  T value{};
  const auto error = test::input_error_of([&] { codec->read(Json::parse(text), "/v", value); });
  if (!error) return "";
  EXPECT_EQ(error->kind(), InputError::Kind::shape);
  return error->what();
}

const CodecPtr<double> kForce = number({0.0, 10.0, "N"});
const CodecPtr<double> kMass = number({0.0, 1e6, "kg", true});

TEST(NumberCodec, AcceptsItsBounds) {
  EXPECT_EQ(value_of(kForce, "0"), 0.0);
  EXPECT_EQ(value_of(kForce, "10"), 10.0);
  EXPECT_EQ(value_of(kForce, "1e1"), 10.0);
  EXPECT_EQ(value_of(kMass, "5e-324"), 5e-324);
}

TEST(NumberCodec, RefusesWhatIsBeyondThem) {
  EXPECT_EQ(refusal_of(kForce, "-5e-324"), "/v: got -5e-324; allowed: a number >= 0 and <= 10 [N]");
  EXPECT_EQ(refusal_of(kForce, "10.000000000000002"),
            "/v: got 10.000000000000002; allowed: a number >= 0 and <= 10 [N]");
  EXPECT_EQ(refusal_of(kMass, "0"), "/v: got 0; allowed: a number > 0 and <= 1000000 [kg]");
  EXPECT_EQ(refusal_of(kMass, "-0.0"), "/v: got -0.0; allowed: a number > 0 and <= 1000000 [kg]");
  refusal_of(kForce, "18446744073709551615");
}

TEST(NumberCodec, RefusesWhatIsNotFinite) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    double out = 1.0;
    EXPECT_TRUE(test::input_error_of([&] { kForce->read(Json(value), "/v", out); }));
    EXPECT_EQ(out, 1.0);
  }
}

TEST(NumberCodec, RefusesOtherTypes) {
  for (const char* text : {"\"5\"", "true", "null", "[5]", "{}"}) {
    EXPECT_EQ(refusal_of(kForce, text), std::string("/v: got ") + text + "; allowed: a number >= 0 and <= 10 [N]");
  }
}

const CodecPtr<std::int64_t> kCount = integer(1, std::int64_t{1} << 53);

TEST(IntegerCodec, AcceptsWholeNumbersHoweverTheyAreWritten) {
  EXPECT_EQ(value_of(kCount, "1000"), 1000);
  EXPECT_EQ(value_of(kCount, "1e3"), 1000);
  EXPECT_EQ(value_of(kCount, "1000.0"), 1000);
  EXPECT_EQ(value_of(kCount, "9007199254740992"), 9007199254740992);
}

TEST(IntegerCodec, RefusesFractionsAndWhatIsBeyondItsBounds) {
  for (const char* text :
       {"1.5", "0", "-1", "9007199254740994", "1e300", "-1e300", "18446744073709551615", "-9223372036854775808"}) {
    EXPECT_NE(refusal_of(kCount, text).find("allowed: an integer 1 ... 9007199254740992"), std::string::npos);
  }
}

TEST(IntegerCodec, DoesNotRoundAnIntegerIntoItsRange) {
  // 2^53 + 1 has no double of its own and would round to the bound 2^53.
  EXPECT_NE(refusal_of(kCount, "9007199254740993"), "");
}

TEST(IntegerCodec, RefusesOtherTypes) {
  for (const char* text : {"\"5\"", "true", "null", "[5]", "{}"}) EXPECT_NE(refusal_of(kCount, text), "");
}

TEST(BooleanCodec, AcceptsTrueAndFalseAlone) {
  EXPECT_TRUE(value_of(boolean(), "true"));
  EXPECT_FALSE(value_of(boolean(), "false", true));
  for (const char* text : {"0", "1", "\"true\"", "null", "[]"}) {
    EXPECT_EQ(refusal_of(boolean(), text), std::string("/v: got ") + text + "; allowed: true or false");
  }
}

TEST(TextCodec, CountsCharactersNotBytes) {
  EXPECT_EQ(value_of(text(3), R"("abc")"), "abc");
  EXPECT_EQ(value_of(text(3), R"("äöü")"), "äöü");
  EXPECT_EQ(value_of(text(1), R"("😀")"), "😀");
  EXPECT_EQ(refusal_of(text(3), R"("abcd")"), R"(/v: got "abcd"; allowed: a text of at most 3 characters)");
  EXPECT_NE(refusal_of(text(2), R"("äöü")"), "");
  EXPECT_NE(refusal_of(text(3), "5"), "");
}

const CodecPtr<std::string> kTip = name_of({"flat", "round"}, "tip");

TEST(NameCodec, AcceptsItsNamesExactly) {
  EXPECT_EQ(value_of(kTip, R"("round")"), "round");
  for (const char* text : {R"("Round")", R"("round ")", R"("")", "1", "null", R"(["round"])"}) refusal_of(kTip, text);
}

TEST(NameCodec, NamesTheNearest) {
  EXPECT_EQ(refusal_of(kTip, R"("rond")"),
            R"(/v: got "rond"; allowed: tip: one of "flat", "round"; nearest valid name: "round")");
  EXPECT_EQ(refusal_of(kTip, R"("pointed")"), R"(/v: got "pointed"; allowed: tip: one of "flat", "round")");
}

TEST(Vector3Codec, ReadsThreeNumbers) {
  EXPECT_EQ(value_of(vector3({-1, 1, "m"}), "[0.5, -1, 1]", Vec3(0, 0, 0)), Vec3(0.5, -1, 1));
}

TEST(Vector3Codec, RefusesOtherSizesAndNamesABadComponent) {
  const auto codec = vector3({-1, 1, "m"});
  for (const char* text : {"[]", "[1, 1]", "[1, 1, 1, 1]", "1", "{}", "null"}) {
    EXPECT_NE(refusal_of(codec, text).find("/v: got "), std::string::npos);
  }
  EXPECT_EQ(refusal_of(codec, "[0, 2, 0]"), "/v/1: got 2; allowed: a number >= -1 and <= 1 [m]");
  EXPECT_EQ(refusal_of(codec, "[0, 0, \"0\"]").substr(0, 10), "/v/2: got ");
}

TEST(ListCodec, ReplacesWhatWasThere) {
  const auto codec = list_of(integer(0, 9), 0, 3);
  EXPECT_EQ(value_of(codec, "[3, 1]", {7, 7, 7}), (std::vector<std::int64_t>{3, 1}));
  EXPECT_EQ(value_of(codec, "[]", {7}), std::vector<std::int64_t>{});
}

TEST(ListCodec, RefusesTooFewTooManyAndNamesABadEntry) {
  const auto codec = list_of(integer(0, 9), 1, 3);
  EXPECT_EQ(refusal_of(codec, "[]"), "/v: got []; allowed: a list of 1 ... 3 entries, each an integer 0 ... 9");
  EXPECT_NE(refusal_of(codec, "[1, 2, 3, 4]"), "");
  EXPECT_NE(refusal_of(codec, "{}"), "");
  EXPECT_EQ(refusal_of(codec, "[1, 2, 10]"), "/v/2: got 10; allowed: an integer 0 ... 9");
}

TEST(NullableCodec, ReadsNullAsNoneAndAnythingElseAsTheValue) {
  const auto codec = nullable(kForce);
  EXPECT_EQ(value_of(codec, "null", {5.0}), std::nullopt);
  EXPECT_EQ(value_of(codec, "5"), 5.0);
  EXPECT_EQ(refusal_of(codec, "11"), "/v: got 11; allowed: null or a number >= 0 and <= 10 [N]");
  EXPECT_EQ(refusal_of(nullable(vector3({0, 1})), "[0, 2, 0]"), "/v/1: got 2; allowed: a number >= 0 and <= 1");
}

/// Reading what was written gives the value again.
template <class T>
void expect_round_trip(const CodecPtr<T>& codec, const T& value) {
  T again{};
  codec->read(Json::parse(codec->write(value).dump()), "/v", again);
  EXPECT_EQ(again, value);
}

TEST(ValueCodecs, ReadWhatTheyWrite) {
  expect_round_trip(kForce, 0.1);
  expect_round_trip(kMass, std::numeric_limits<double>::denorm_min());
  expect_round_trip(kCount, std::int64_t{1} << 53);
  expect_round_trip(boolean(), true);
  expect_round_trip(text(100), std::string("\"\\\n ä \x01"));
  expect_round_trip(kTip, std::string("flat"));
  expect_round_trip(vector3({-1, 1}), Vec3(0.1, -0.2, 1.0 / 3.0));
  expect_round_trip(list_of(kForce, 0, 9), {0.1, 0.2});
  expect_round_trip(nullable(kForce), std::optional<double>());
  expect_round_trip(nullable(kForce), std::optional(0.3));
}

TEST(ValueCodecs, DescribeThemselvesAsSchemas) {
  EXPECT_EQ(kForce->schema(), Json::parse(R"({"type": "number", "minimum": 0.0, "maximum": 10.0})"));
  EXPECT_EQ(kMass->schema(), Json::parse(R"({"type": "number", "exclusiveMinimum": 0.0, "maximum": 1e6})"));
  EXPECT_EQ(integer(1, 5)->schema(), Json::parse(R"({"type": "integer", "minimum": 1, "maximum": 5})"));
  EXPECT_EQ(text(5)->schema(), Json::parse(R"({"type": "string", "maxLength": 5})"));
  EXPECT_EQ(kTip->schema(), Json::parse(R"({"type": "string", "enum": ["flat", "round"]})"));
  EXPECT_EQ(nullable(boolean())->schema(), Json::parse(R"({"anyOf": [{"type": "null"}, {"type": "boolean"}]})"));
  EXPECT_EQ(list_of(boolean(), 1, 2)->schema(),
            Json::parse(R"({"type": "array", "items": {"type": "boolean"}, "minItems": 1, "maxItems": 2})"));
}

}  // namespace
}  // namespace hapbench
