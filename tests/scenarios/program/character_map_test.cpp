#include "scenarios/program/table.hpp"

#include <gtest/gtest.h>

namespace hapbench::character_map_test {
namespace {

TEST(CharacterMap, HasTheFirstRowBelow) {
  const auto cell = [](std::size_t column, std::size_t row) { return row == 0 ? 'a' : column == 1 ? 'c' : 'b'; };
  EXPECT_EQ(character_map({"x", 2, "1", "9"}, "y", {"low", "high"}, cell),
            "       high   b c  y\n"
            "        low   a a\n"
            "             1 ... 9  x\n");
}

}  // namespace
}  // namespace hapbench::character_map_test
