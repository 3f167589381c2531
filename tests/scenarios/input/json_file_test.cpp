#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::json_file_test {
namespace {

std::string refusal_of(const std::string& text) {
  SCOPED_TRACE(text.substr(0, 100));
  const auto error = test::input_error_of([&] { parse_json(text); });
  if (!error) return "";
  EXPECT_EQ(error->kind(), InputError::Kind::shape);
  return error->what();
}

std::string nested(int levels) {
  return std::string(static_cast<std::size_t>(levels), '[') + std::string(static_cast<std::size_t>(levels), ']');
}

TEST(ParseJson, ReadsJsonAndKeepsTheOrderOfKeys) {
  EXPECT_EQ(parse_json(" {\"b\": [1, -2.5e3, true, null, \"\\u00e4\"], \"a\": {}}\n").dump(),
            "{\"b\":[1,-2500.0,true,null,\"\xc3\xa4\"],\"a\":{}}");
}

TEST(ParseJson, IgnoresAByteOrderMark) {
  // RFC 8259, section 8.1: parsers may ignore it; editors on some systems write it.
  EXPECT_EQ(parse_json("\xef\xbb\xbf{\"a\": 1}"), parse_json("{\"a\": 1}"));
}

TEST(ParseJson, SaysWhereTheSyntaxIsWrongAndWhatWasExpected) {
  EXPECT_EQ(
      refusal_of("{\n\"a\": 1,}"),
      "is not JSON: parse error at line 2, column 8: syntax error while parsing object key - unexpected '}'; expected "
      "string literal");
  EXPECT_EQ(
      refusal_of("[1, \"\xff\"]").find("is not JSON: parse error at line 1, column 6: syntax error while parsing"), 0u);
  EXPECT_LT(refusal_of("\"" + std::string(1'000'000, 'x')).size(), 200u) << "cut";
  EXPECT_EQ(refusal_of(std::string("{\0}", 3)), "is not JSON: has a zero byte; allowed: UTF-8");
}

TEST(ParseJson, RefusesNumbersBeyondDouble) {
  EXPECT_EQ(refusal_of("{\"time\": {\"step_s\": 1e999}}"), "/time/step_s: got 1e999; allowed: finite numbers");
  EXPECT_EQ(refusal_of("[1, -1e400]"), "/1: got -1e400; allowed: finite numbers");
  EXPECT_LT(refusal_of("[1" + std::string(100'000, '0') + "]").size(), 200u);
  EXPECT_EQ(parse_json("[1e308, 1e-999]"), Json::parse("[1e308, 0.0]"));
}

TEST(ParseJson, RefusesDuplicateKeysButNotEqualKeysOfDifferentObjects) {
  EXPECT_EQ(refusal_of("{\"a\": 1, \"b\": 2, \"a\": 1}"), "/a: the key stands twice in one object; allowed: once");
  EXPECT_EQ(refusal_of("{\"x\": [{}, {\"a\": 1, \"\\u0061\": 2}]}"),
            "/x/1/a: the key stands twice in one object; allowed: once");
  EXPECT_NO_THROW(parse_json("{\"a\": {\"a\": [{\"a\": 1}, {\"a\": 1}]}, \"b\": {\"a\": 1}}"));
}

TEST(ParseJson, RefusesDeepNesting) {
  EXPECT_NO_THROW(parse_json(nested(64)));
  EXPECT_NE(refusal_of(nested(65)).find("nested too deeply; allowed: 64 levels"), std::string::npos);
}

TEST(ParseJson, RefusesObjectsWithMoreThanTenThousandKeys) {
  const auto object_with = [](int keys) {
    std::string text = "{";
    for (int i = 0; i < keys; ++i) text += (i > 0 ? ",\"k" : "\"k") + std::to_string(i) + "\":0";
    return text + "}";
  };
  EXPECT_EQ(parse_json(object_with(10'000)).size(), 10'000u);
  EXPECT_NE(refusal_of(object_with(10'001)).find("more than 10000 keys"), std::string::npos);
}

TEST(ReadTextFile, RefusesANameThatTheSystemWouldCut) {
  EXPECT_TRUE(test::input_error_of([] { read_text_file(std::string("/dev/null\0more", 14), 100); }));
}

TEST(ReadTextFile, ReadsUpToItsLimitAndNoFurther) {
  const test::TemporaryDirectory directory;
  const std::string contents(1 << 20, 'x');
  test::write_plainly(directory / "file", contents);
  EXPECT_EQ(read_text_file(directory / "file", contents.size()), contents);
  const auto refusal = test::input_error_of([&] { read_text_file(directory / "file", contents.size() - 1); });
  ASSERT_TRUE(refusal);
  EXPECT_NE(refusal->problem().find("is larger than"), std::string::npos);
  // A device without end stops at the limit too.
  EXPECT_TRUE(test::input_error_of([] { read_text_file("/dev/zero", 1 << 20); }));
}

const std::vector<std::string> kNames = {"stiffness_N_per_m", "damping_ratio", "mass_kg", "mu_s_N_s_per_m", "mean"};

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

TEST(NearestName, SuggestsNothingForSomethingElse) {
  EXPECT_EQ(nearest_name("colour", kNames), "");
  EXPECT_EQ(nearest_name("", kNames), "");
  EXPECT_EQ(nearest_name("x", kNames), "");
  EXPECT_EQ(nearest_name("mean", {}), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'm'), kNames), "");
}

TEST(Numbers, AreTheWholeWordOrNone) {
  EXPECT_EQ(finite_number("-1.5e-3"), -0.0015);
  EXPECT_EQ(finite_number("0"), 0.0);
  for (const char* word : {"", "+1", "1.0x", "x", "nan", "inf", "-inf", "1e999", "0x10", " 1", "1,5"})
    EXPECT_EQ(finite_number(word), std::nullopt) << word;
  EXPECT_EQ(whole_number("18446744073709551615"), 18446744073709551615u);
  for (const char* word : {"", "-1", "+1", "1.0", "18446744073709551616", "x"})
    EXPECT_EQ(whole_number(word), std::nullopt) << word;
}

const std::filesystem::path kFile = "t.csv";

TEST(CsvReader, GivesRowsAsCells) {
  CsvReader csv{LineReader("a,b\r\n 1 ,\t2\r\n,\n\n3,4"), kFile};
  EXPECT_EQ(csv.header(), "a,b");
  EXPECT_EQ(csv.columns(), (Words{"a", "b"}));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"1", "2"}));
  EXPECT_EQ(csv.line(), 2u);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"", ""}));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.cells(), (Words{"3", "4"}));
  EXPECT_EQ(csv.line(), 5u);
  EXPECT_FALSE(csv.next());
}

TEST(NumberTable, MayHaveBlanksBlankLinesCarriageReturnsAndAsManyRowsAsAllowed) {
  const std::string text = "a,b\r\n\r\n 1 ,\t2\r\n  \n3,4";
  EXPECT_EQ(number_table_in(text, kFile, {"a,b"}, 2).values, (std::vector<double>{1, 2, 3, 4}));
  const auto error = test::input_error_of([&] { number_table_in(text, kFile, {"a,b"}, 1); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "t.csv, line 5: more than 1 rows");
}

}  // namespace
}  // namespace hapbench::json_file_test
