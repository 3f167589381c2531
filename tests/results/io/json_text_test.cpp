#include "results/io/columns.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace hapbench::json_text_test {
namespace {

using nlohmann::ordered_json;

TEST(JsonText, KeepsTheOrderOfKeysAndWritesPlainArraysOnOneLine) {
  const ordered_json value = {{"z", 1},
                              {"a", {0.1, 2, "x", nullptr, true}},
                              {"nested", {{"points", {{0, 1}, {2, 3}}}}},
                              {"none", ordered_json::object()},
                              {"empty", ordered_json::array()}};
  EXPECT_EQ(json_text(value), R"({
  "z": 1,
  "a": [0.1, 2, "x", null, true],
  "nested": {
    "points": [
      [0, 1],
      [2, 3]
    ]
  },
  "none": {},
  "empty": []
}
)");
}

TEST(JsonText, WritesNumbersThatAreNotFiniteAsNull) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(json_text({inf, -inf, std::nan("")}), "[null, null, null]\n");
}

TEST(JsonText, EscapesStringsAndKeysAndReplacesBytesThatAreNotUtf8) {
  ordered_json value;
  value["a\"b"] = "line\nend \xff";
  EXPECT_EQ(json_text(value), "{\n  \"a\\\"b\": \"line\\nend \xef\xbf\xbd\"\n}\n");
}

// nlohmann's own writer gives 5e-324 as 4.94…e-324 and whole numbers a ".0".
TEST(JsonText, WritesDoublesInShortestForm) {
  EXPECT_EQ(json_text({0.1, 1.0, 5e-324, 1e22, -0.0}), "[0.1, 1, 5e-324, 1e+22, -0]\n");
}

}  // namespace
}  // namespace hapbench::json_text_test
