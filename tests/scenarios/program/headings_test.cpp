#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "scenarios/format/text_lines.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/report.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// What stands above the columns of printed tables is known to `describe`; tables are as wide as the terminal.
namespace hapbench::headings_test {
namespace {

using Words = std::vector<std::string>;

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

/// The titles over the rule under a table's header, each of one or two lines.
void add_titles(const std::string& upper, const std::string& lower, const std::string& rule,
                std::set<std::pair<std::string, std::string>>& titles) {
  static const std::regex kColumn("-+");
  for (std::sregex_iterator column(rule.begin(), rule.end(), kColumn), end; column != end; ++column) {
    const auto at = static_cast<std::size_t>(column->position()), wide = static_cast<std::size_t>(column->length());
    const auto part = [&](const std::string& line) { return at < line.size() ? trimmed(line.substr(at, wide)) : ""; };
    // A sweep of two fields has values above its columns.
    if (!finite_number(part(lower))) titles.emplace(part(upper), part(lower));
  }
}

std::set<std::pair<std::string, std::string>> titles_in(const std::string& text) {
  static const std::regex kRule(" *-+( +-+)*");
  std::set<std::pair<std::string, std::string>> titles;
  const std::vector<std::string> lines = test::lines_of(text);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (std::regex_match(lines[i], kRule)) add_titles(i > 1 ? lines[i - 2] : "", lines[i - 1], lines[i], titles);
  }
  return titles;
}

bool is_described(const std::string& name) {
  return test::hapbench_here({"describe", name}).status == 0;
}

/// A title of two lines is one name, or the name of a scene above that of an algorithm.
bool is_described(const std::string& upper, const std::string& lower) {
  if (upper.empty()) {
    const std::size_t slash = lower.find(" \\ ");
    return slash == std::string::npos ? is_described(lower)
                                      : is_described(lower.substr(0, slash)) && is_described(lower.substr(slash + 3));
  }
  return is_described(upper + lower) || is_described(upper + " " + lower) ||
         (is_described(upper) && is_described(lower));
}

TEST(Headings, OfEveryTableAreKnownToDescribeAndFitATerminal) {
  const test::TemporaryDirectory directory;
  test::ProgramOptions options;
  options.directory = directory.path();
  options.columns = 80;
  const std::vector<Words> commands = {
      {"run", "springs_limited_mean", "--latency", "--out", "a"},
      {"run", "springs_limited_mean", "--set", "rendering.stiffness_N_per_m=1e4", "--set", "expect={}", "--out", "b"},
      {"run", "vertical_peg_in_hole_shaped_stiffness", "--set", "hand.trials=1", "--set", "hand.task.time_limit_s=1",
       "--set", "hand.task.targets_per_place=1", "--set", "expect={}"},
      {"compare", "springs_limited_mean", "--algorithms", "mean,summation", "--out", "c"},
      {"compare", "recorded_wipe", "--algorithms", "mean,summation"},
      {"compare", "springs_limited_mean", "--algorithms", "mean,summation", "--seeds", "2"},
      {"compare", "springs_limited_mean", "springs_limited_summation", "--algorithms", "mean,summation"},
      {"limit", "tap_wall", "--device", "touch,ideal", "--set", "time.steps=200", "--resolution", "0.5"},
      {"limit", "single_spring", "--vary", "rendering.stiffness_N_per_m", "--resolution", "0.5"},
      {"limit", "single_spring", "--vary", "rendering.mass_kg", "--smallest", "--resolution", "0.5"},
      {"sweep", "springs_limited_mean", "--vary", "rendering.mass_kg=0.1,0.2", "--set", "expect={}"},
      {"sweep", "springs_limited_mean", "--vary", "rendering.mass_kg=0.1,0.2", "--vary", "time.steps=100,200", "--set",
       "expect={}"},
      {"sweep", "springs_limited_mean", "--vary", "rendering.mass_kg=0.1:0.2", "--vary", "seed=1,2", "--vary",
       "rendering.stiffness_N_per_m=1e4:2e4:log", "--sample", "lhs:4", "--set", "expect={}", "--out", "s"},
      {"converge", "springs_oscillation", "--metric", "force_max_N,final_position_m.x", "--levels", "3"},
      {"compare", "springs_oscillation", "--errors", "--algorithms", "mean,summation", "--out", "g"},
      {"tune", "single_spring"},
      {"stress", "--count", "10"},
      {"reproduce", "--only", "R2"}};
  std::set<std::pair<std::string, std::string>> titles;
  for (const Words& words : commands) {
    const test::ProgramRun run = test::hapbench(words, options);
    EXPECT_TRUE(run.status == 0 || run.status == 3) << words[0] << " " << words[1] << ": " << run.err;
    const auto found = titles_in(run.out);
    EXPECT_FALSE(found.empty()) << words[0] << " " << words[1] << " prints no table:\n" << run.out;
    titles.insert(found.begin(), found.end());
    for (const std::string& line : test::lines_of(run.out))  // a path may be longer
      EXPECT_TRUE(line.size() <= 80u || line.find(' ', 2) == std::string::npos) << words[0] << ": " << line;
  }
  for (const auto& file : std::filesystem::recursive_directory_iterator(directory.path())) {
    const std::string name = file.path().filename().string();
    // The choice of tune is a scenario.
    if (!file.is_regular_file() || name.ends_with("_tuned.json")) continue;
    EXPECT_TRUE(is_described(name)) << file.path();
  }
  EXPECT_GT(titles.size(), 70u);
  for (const auto& [upper, lower] : titles) EXPECT_TRUE(is_described(upper, lower)) << upper << " / " << lower;
}

/// Also those of tables that no command above prints.
TEST(Headings, OfEveryListHaveAMeaning) {
  for (const DescribedTable& table : result_tables())
    for (const Table::Column& heading : table.headings) EXPECT_TRUE(is_described(heading.title)) << heading.title;
}

TEST(Words, OfTheOutputsAreKnownToDescribe) {
  for (const char* word : {"league.csv", "sweep.json", "quantum", "planar.first_tilt"})
    EXPECT_TRUE(is_described(word)) << word;
}

}  // namespace
}  // namespace hapbench::headings_test
