#include "scenarios/program/describe/glossary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "scenarios/input/text_lines.hpp"

/// Tests the entries of scenarios/GLOSSARY.md, as `hapbench describe` finds them.
namespace hapbench::glossary_test {
namespace {

/// Returns the letters and digits of a name in lower case; the entries are ordered by this text.
std::string letters_of(const std::string& name) {
  std::string letters = lower_case(name);
  std::erase_if(letters, [](unsigned char c) { return std::isalnum(c) == 0; });
  return letters;
}

TEST(Glossary, FindsEachNameOfEachEntry) {
  const Index terms = glossary_index(Layout());
  ASSERT_GT(terms.size(), 100u);
  for (const IndexEntry& term : terms) {
    EXPECT_TRUE(find_term(terms, term.name)) << term.name;
    for (const std::string_view alias : parts_of(term.name, ','))
      EXPECT_TRUE(find_term(terms, alias.substr(0, alias.find('(')))) << alias;
  }
  EXPECT_TRUE(find_term(terms, "6-dof")) << "case is ignored";
  EXPECT_TRUE(find_term(terms, "linear_limit")) << "an underscore equals a blank";
  EXPECT_FALSE(find_term(terms, "no such term"));
  EXPECT_FALSE(find_term(terms, ""));
}

TEST(Glossary, IsInAlphabeticalOrderWithShortEntries) {
  const Index terms = glossary_index(Layout());
  EXPECT_TRUE(std::ranges::is_sorted(terms, {}, [](const IndexEntry& term) { return letters_of(term.name); }));
  for (const IndexEntry& term : terms) EXPECT_LE(term.summary.size(), 200u) << term.name << ": at most two lines";
}

}  // namespace
}  // namespace hapbench::glossary_test
