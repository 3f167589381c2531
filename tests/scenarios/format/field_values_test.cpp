#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "scenarios/format/json_file.hpp"
#include "tests/scenarios/support/visitors.hpp"

/// Numbers, names, vectors, lists and null as they are read, written and described by a schema, and how messages name
/// a place (JSON pointer, RFC 6901) and show a value.
namespace hapbench::field_values_test {
namespace {

enum class Tip { flat, round, unnamed };
constexpr Choice<Tip> kTips[] = {{"flat", Tip::flat}, {"round", Tip::round}};

/// A kind of value, as the tests below describe it.
template <class T>
struct Kind {
  void (*describe)(Fields&, T&);

  T value_of(const std::string& text, T value = {}) const {
    test::read_json(Json::parse(text), "/v", value, describe);
    return value;
  }
  std::string refusal_of(const std::string& text) const { return test::refusal_of(text, T{}, describe); }
  Json written(const T& value) const { return test::written_by(describe, value); }
  Json schema() const { return test::schema_of(describe, T{}); }
};

const Kind<double> kForce = {[](Fields& f, double& v) { f.number(v, {0.0, 10.0, "N"}); }};
const Kind<double> kMass = {[](Fields& f, double& v) { f.number(v, {0.0, 1e6, "kg", true}); }};
const Kind<std::int64_t> kCount = {[](Fields& f, std::int64_t& v) { f.integer(v, {1, std::int64_t{1} << 53}); }};
const Kind<std::uint64_t> kSeed = {[](Fields& f, std::uint64_t& v) { f.integer(v, {0, std::int64_t{1} << 53}); }};
const Kind<bool> kSwitch = {[](Fields& f, bool& v) { f.boolean(v); }};
const Kind<std::string> kShortText = {[](Fields& f, std::string& v) { f.text(v, 3); }};
const Kind<Tip> kTip = {[](Fields& f, Tip& v) { f.choice(v, kTips, "tip"); }};
const Kind<Vec3> kVector = {[](Fields& f, Vec3& v) { f.vector3(v, {-1, 1, "m"}); }};
const Kind<std::vector<std::int64_t>> kDigits = {[](Fields& f, std::vector<std::int64_t>& v) {
  f.list(v, {1, 3}, [](Fields& entry, std::int64_t& digit) { entry.integer(digit, {0, 9}); });
}};
const Kind<std::optional<double>> kForceOrNull = {[](Fields& f, std::optional<double>& v) {
  f.nullable(v, [](Fields& inner, double& force) { inner.number(force, {0.0, 10.0, "N"}); });
}};

TEST(Number, MayBeAtItsBounds) {
  EXPECT_EQ(kForce.value_of("0"), 0.0);
  EXPECT_EQ(kForce.value_of("10"), 10.0);
  EXPECT_EQ(kForce.value_of("1e1"), 10.0);
  EXPECT_EQ(kMass.value_of("5e-324"), 5e-324);
}

TEST(Number, IsRefusedWhenNotFinite) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    double out = 1.0;
    EXPECT_TRUE(test::input_error_of([&] { test::read_json(Json(value), "/v", out, kForce.describe); }));
    EXPECT_EQ(out, 1.0);
  }
}

TEST(Integer, MayBeWrittenAsAnyWholeNumber) {
  EXPECT_EQ(kCount.value_of("1000"), 1000);
  EXPECT_EQ(kCount.value_of("1e3"), 1000);
  EXPECT_EQ(kCount.value_of("1000.0"), 1000);
  EXPECT_EQ(kCount.value_of("9007199254740992"), 9007199254740992);
  EXPECT_EQ(kSeed.value_of("9007199254740992"), 9007199254740992u);
}

TEST(Integer, IsRefusedAsAFractionAndBeyondItsBounds) {
  // 2^53 + 1 has no double of its own and would round to the bound 2^53.
  for (const char* text : {"1.5", "0", "-1", "9007199254740993", "9007199254740994", "1e300", "-1e300",
                           "18446744073709551615", "-9223372036854775808"}) {
    EXPECT_NE(kCount.refusal_of(text).find("allowed: an integer 1 ... 9007199254740992"), std::string::npos);
  }
}

TEST(Values, OfAnotherTypeAreRefusedWithWhatIsAllowed) {
  const auto expect_refused = [](const auto& kind, const std::string& allowed,
                                 std::initializer_list<const char*> texts) {
    for (const char* text : texts)
      EXPECT_EQ(kind.refusal_of(text), std::string("/v: got ") + text + "; allowed: " + allowed);
  };
  expect_refused(kForce, "a number >= 0 and <= 10 [N]", {"\"5\"", "true", "null", "[5]", "{}"});
  expect_refused(kCount, "an integer 1 ... 9007199254740992", {"\"5\"", "true", "null", "[5]", "{}"});
  expect_refused(kSwitch, "true or false", {"0", "1", "\"true\"", "null", "[]"});
  expect_refused(kShortText, "a text of at most 3 characters", {"5", "null", "\"abcd\""});
  expect_refused(kTip, R"(tip: one of "flat", "round")", {R"("")", "1", "null", R"(["round"])"});
  expect_refused(kVector, "three numbers [x, y, z], each a number >= -1 and <= 1 [m]",
                 {"[]", "[1,1]", "[1,1,1,1]", "1", "{}", "null"});
  expect_refused(kDigits, "a list of 1 ... 3 entries, each an integer 0 ... 9", {"[]", "[1,2,3,4]", "{}"});
}

TEST(Text, IsMeasuredInCharactersNotBytes) {
  EXPECT_EQ(kShortText.value_of(R"("abc")"), "abc");
  EXPECT_EQ(kShortText.value_of(R"("äöü")"), "äöü");
  EXPECT_EQ(kShortText.value_of(R"("😀😀😀")"), "😀😀😀");
  EXPECT_NE(kShortText.refusal_of(R"("äöüß")"), "");
}

TEST(Name, IsSuggestedWhenNear) {
  EXPECT_NE(kTip.refusal_of(R"("round ")"), "");
  EXPECT_EQ(kTip.refusal_of(R"("rond")"),
            R"(/v: got "rond"; allowed: tip: one of "flat", "round"; nearest valid name: "round")");
  EXPECT_EQ(kTip.refusal_of(R"("pointed")"), R"(/v: got "pointed"; allowed: tip: one of "flat", "round")");
}

TEST(Name, IsNotInventedForAValueWithoutOne) {
  EXPECT_THROW(kTip.written(Tip::unnamed), std::logic_error);
}

TEST(Vector, NamesABadComponent) {
  EXPECT_EQ(kVector.refusal_of("[0, 2, 0]"), "/v/1: got 2; allowed: a number >= -1 and <= 1 [m]");
  EXPECT_EQ(kVector.refusal_of("[0, 0, \"0\"]").substr(0, 10), "/v/2: got ");
}

TEST(Nullable, IsNullForNoneAndElseTheValue) {
  EXPECT_EQ(kForceOrNull.value_of("null", {5.0}), std::nullopt);
  EXPECT_EQ(kForceOrNull.value_of("5"), 5.0);
  EXPECT_EQ(kForceOrNull.refusal_of("11"), "/v: got 11; allowed: null or a number >= 0 and <= 10 [N]");
}

TEST(Nullable, OffersNullForTheWholeValueAlone) {
  const auto describe = [](Fields& f, std::optional<Vec3>& v) {
    f.nullable(v, [](Fields& inner, Vec3& vector) { inner.vector3(vector, {0, 1}); });
  };
  EXPECT_EQ(test::refusal_of("[0, 2, 0]", std::optional<Vec3>(), describe),
            "/v/1: got 2; allowed: a number >= 0 and <= 1");
}

/// Reading what was written gives the value again.
template <class T>
void expect_round_trip(const Kind<T>& kind, const T& value) {
  EXPECT_EQ(kind.value_of(kind.written(value).dump()), value);
}

TEST(Pointer, EscapesTildeAndSlashAsRfc6901Says) {
  // The examples of RFC 6901, section 5.
  EXPECT_EQ(member("", "a/b"), "/a~1b");
  EXPECT_EQ(member("", "m~n"), "/m~0n");
  EXPECT_EQ(member("", "~1"), "/~01");
  EXPECT_EQ(member("", ""), "/");
  EXPECT_EQ(member("", " "), "/ ");
  EXPECT_EQ(member("", "k\"l"), "/k\"l");
  EXPECT_EQ(element(member("", "foo"), 0), "/foo/0");
}

TEST(Pointer, IsOneShortLineWhateverTheKey) {
  EXPECT_EQ(member("", std::string(1'000'000, 'k')), "/" + std::string(200, 'k'));
  EXPECT_EQ(member("", "a\nb\tc\x1b"), "/a?b?c?");
}

TEST(ShownValue, IsCutWhenLong) {
  const std::string text = shown(Json(std::string(1000, 'x')));
  EXPECT_EQ(text, "\"" + std::string(79, 'x') + "...");
  EXPECT_EQ(shown(Json(std::vector<int>(1'000'000))), "a list of 1000000 entries");
  Json object = Json::object();
  for (int i = 0; i < 21; ++i) object["k" + std::to_string(i)] = i;
  EXPECT_EQ(shown(object), "an object of 21 entries");
}

TEST(ShownValue, IsAsciiEvenForBytesThatAreNoText) {
  for (const char* bytes : {"\xc3\xa4", "\xff\xfe", "\xed\xa0\x80", "\xe2\x80\xa8"}) {
    const std::string text = shown(Json(bytes));
    EXPECT_EQ(text.find_first_not_of("\"\\u0123456789abcdef"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace hapbench::field_values_test
