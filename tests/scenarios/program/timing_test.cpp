#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::timing_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::hapbench;
using test::ProgramRun;
using test::read_file;

// Tests the measured run times of laws (compare --time) and of settings (converge --over).

TEST(Timing, OfLawsIsInATableOfItsOwn) {
  const test::TemporaryDirectory directory;
  const auto out = [&directory](const char* name) { return (directory / name).string(); };
  const std::vector<std::string> laws = {"compare", "tap_wall", "--algorithms", "mean,proxy", "--json"};
  const auto with = [&laws](std::vector<std::string> more) {
    more.insert(more.begin(), laws.begin(), laws.end());
    return more;
  };
  const ProgramRun plain = hapbench(with({"--out", out("plain")}));
  const ProgramRun timed = hapbench(with({"--out", out("timed"), "--time"}));
  ASSERT_EQ(timed.status, 0) << timed.err;
  EXPECT_EQ(read_file(directory / "plain/comparison.csv"), read_file(directory / "timed/comparison.csv"));
  EXPECT_FALSE(fs::exists(directory / "plain/comparison_timing.csv"));
  const json answer = json::parse(timed.out);
  ASSERT_EQ(answer["times"].size(), 2u);
  EXPECT_EQ(answer["runs"], json::parse(plain.out)) << "the runs are the same";
  EXPECT_EQ(answer["times"][0]["rank"], 1);
  for (const json& law : answer["times"]) {
    EXPECT_GT(law["seconds_per_step"], 0.0);
    EXPECT_GE(law["spread_s"], 0.0);
  }
  // Without --time, the table of an earlier comparison is removed.
  ASSERT_EQ(hapbench(with({"--out", out("timed")})).status, 0);
  EXPECT_FALSE(fs::exists(directory / "timed/comparison_timing.csv"));
}

TEST(Timing, IsAMetricOfARanking) {
  const test::TemporaryDirectory directory;
  const ProgramRun run = hapbench({"compare", "tap_wall", "--algorithms", "mean,proxy", "--by", "time,force_max_N",
                                   "--json", "--out", (directory / "out").string()});
  ASSERT_EQ(run.status, 0) << run.err;
  const json answer = json::parse(run.out);
  EXPECT_EQ(answer["times"].size(), 2u);
  for (const json& entry : answer["ranking"]) EXPECT_EQ(entry["metric"], "force_max_N");
}

TEST(Timing, OfSettingsHasErrorsThatDoNotDependOnTheRun) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string();
  const std::vector<std::string> words = {"converge", "single_spring",
                                          "--over",   "integrator.type=leapfrog,rk4",
                                          "--set",    "rendering.stiffness_N_per_m=500",
                                          "--levels", "3",
                                          "--out",    out};
  const ProgramRun first = hapbench(words);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_NE(first.out.find("ms per simulated second"), std::string::npos) << first.out;
  const std::string errors = read_file(directory / "out/convergence.csv");
  EXPECT_EQ(std::ranges::count(errors, '\n'), 7) << "a header, and three steps of two integrators";
  ASSERT_EQ(hapbench(words).status, 0);
  EXPECT_EQ(read_file(directory / "out/convergence.csv"), errors);
  for (const auto& [option, value] : {std::pair{"--vary", "environment.spacing_m"},
                                      {"--metric", "force_max_N"},
                                      {"--to", "1%"},
                                      {"--over", "no.such=1"}}) {
    std::vector<std::string> wrong = words;
    wrong.insert(wrong.end(), {option, value});
    EXPECT_EQ(hapbench(wrong).status, 2) << option;
  }
}

}  // namespace
}  // namespace hapbench::timing_test
