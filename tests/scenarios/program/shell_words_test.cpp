#include "scenarios/input/shell_words.hpp"

#include <gtest/gtest.h>

#include "tests/scenarios/support/program.hpp"

namespace hapbench::shell_words_test {
namespace {

TEST(ShellWords, AreReadBackByAShell) {
  const std::vector<std::string> words = {
      "plain.json", "my tooth.json", "it's", "$HOME", "`id`", "a\"b", "*", "~", "=ls",
      "",           "a\nb",          "a;b",  "#c",    "ü",    "\\",   "!x"};
  for (const std::string& word : words) {
    const auto run = test::run_program("/bin/sh", {"-c", "printf %s " + shell_word(word)});
    EXPECT_EQ(run.out, word) << shell_word(word);
  }
  const auto run = test::run_program("/bin/sh", {"-c", "printf '[%s]' " + shell_line({"a b", "c", ""})});
  EXPECT_EQ(run.out, "[a b][c][]");
}

TEST(ShellWords, OfFilesAreNoOptions) {
  EXPECT_EQ(shell_file("-x.json"), "./-x.json");
  EXPECT_EQ(shell_file("--out dir"), "'./--out dir'");
  EXPECT_EQ(shell_file("a/-x.json"), "a/-x.json");
}

}  // namespace
}  // namespace hapbench::shell_words_test
