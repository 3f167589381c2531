#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>
#include <string>

#include "scenarios/input/json_file.hpp"

/// How messages name a place (JSON pointer, RFC 6901) and show a value.
namespace hapbench::pointer_test {
namespace {

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

TEST(Pointer, LeadsToTheValueItNames) {
  const Json json = Json::parse(R"({"a/b": {"~": [1, {"": 2}]}})");
  const std::string at = member(element(member(member("", "a/b"), "~"), 1), "");
  EXPECT_EQ(json.at(Json::json_pointer(at)), 2);
}

TEST(Pointer, OfAHugeKeyIsCut) {
  EXPECT_EQ(member("", std::string(1'000'000, 'k')), "/" + std::string(200, 'k'));
}

TEST(Pointer, StaysOnOneLine) {
  EXPECT_EQ(member("", "a\nb\tc\x1b"), "/a?b?c?");
}

TEST(ShownValue, IsJsonOnOneLine) {
  EXPECT_EQ(shown(Json::parse(R"({"a": [1, "x", null, true, 2.5]})")), R"({"a":[1,"x",null,true,2.5]})");
  EXPECT_EQ(shown(Json("two\nlines\x1b")), R"("two\nlines\u001b")");
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
}  // namespace hapbench::pointer_test
