#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
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
  // RFC 8259, section 8.1: parsers may ignore a byte order mark; editors on some systems write it.
  EXPECT_EQ(parse_json("\xef\xbb\xbf{\"a\": 1}"), parse_json("{\"a\": 1}"));
}

TEST(ParseJson, ReportsWhereTheSyntaxIsWrongAndWhatWasExpected) {
  EXPECT_EQ(
      refusal_of("{\n\"a\": 1,}"),
      "is not JSON: parse error at line 2, column 8: syntax error while parsing object key - unexpected '}'; expected "
      "string literal; remove the comma before it");
  EXPECT_EQ(
      refusal_of("[1, \"\xff\"]").find("is not JSON: parse error at line 1, column 6: syntax error while parsing"), 0u);
  // Positions count like in an editor: characters instead of bytes, any line end, no byte order mark.
  for (const auto& [text, position] : {std::pair("\xef\xbb\xbf{'a': 1}", "line 1, column 2"),
                                       {"{\"\xc3\xa4\xc3\xb6\": x}", "line 1, column 8"},
                                       {"{\r\"a\": 1,\r}", "line 3, column 1"},
                                       {"{\r\n\"a\": 1,\r\n  }", "line 3, column 3"},
                                       {"{\"a\": \"b\n\"}", "line 1, column 9"}})
    EXPECT_NE(refusal_of(text).find(std::string("parse error at ") + position + ":"), std::string::npos)
        << refusal_of(text);
  EXPECT_LT(refusal_of("\"" + std::string(1'000'000, 'x')).size(), 200u) << "cut";
  EXPECT_EQ(refusal_of(std::string("{\0}", 3)), "is not JSON: has a zero byte; allowed: UTF-8");
}

TEST(ParseJson, NamesTheCauseOfAFrequentMistake) {
  for (const auto& [text, cause] : {std::pair("{\"a\": [1, 2,]}", "; remove the comma before it"),
                                    {"{\"a\": 0,5}", "; a decimal comma? write a decimal point"},
                                    {"{\"a\": 1, // one\n\"b\": 2}", "; JSON has no comments"},
                                    {"# one\n{}", "; JSON has no comments"},
                                    {"{'a': 1}", "; write double quotes around names and texts"},
                                    {"{\"a\": NaN}", "; write null"},
                                    {"{\"a\": nan}", "; write null"},
                                    {"{\"a\": True}", "; write true"}})
    EXPECT_TRUE(refusal_of(text).ends_with(cause)) << refusal_of(text);
}

TEST(ParseJson, RefusesNumbersBeyondDouble) {
  EXPECT_EQ(refusal_of("{\"time\": {\"step_s\": 1e999}}"), "/time/step_s: got 1e999; allowed: finite numbers");
  EXPECT_EQ(refusal_of("[1, -1e400]"), "/1: got -1e400; allowed: finite numbers");
  EXPECT_LT(refusal_of("[1" + std::string(100'000, '0') + "]").size(), 200u);
  EXPECT_EQ(parse_json("[1e308, 5e-324, 0e-999]"), Json::parse("[1e308, 5e-324, 0.0]"));
  // The parser would read a number that is too small as 0. A text may contain such a number.
  const std::string allowed = "; allowed: 0, or a number that double precision can represent";
  EXPECT_EQ(refusal_of("{\"a\": \"\\\" 1e-400\",\n \"b\": [2, -1e-400]}"),
            "line 2, column 11: got \"-1e-400\"" + allowed);
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

TEST(Pointer, EscapesTildeAndSlashAsRfc6901Says) {
  // Check the examples of RFC 6901, section 5.
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
}  // namespace hapbench::json_file_test
