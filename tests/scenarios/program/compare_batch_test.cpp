#include <gtest/gtest.h>

#include <algorithm>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// Comparisons of several scenarios or seeds.
namespace hapbench::compare_batch_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using Words = std::vector<std::string>;

class CompareBatch : public testing::Test {
 protected:
  CompareBatch() {
    for (const char* name : {"press", "poke"}) {
      // A round tip pressed onto a plane, from two heights.
      test::write_plainly(directory_ / (std::string(name) + ".json"),
                          std::string(R"({"time": {"step_s": 0.0005, "steps": 100}, "tool": {"tip": "round"},
                              "environment": {"type": "plane"}, "hand": {"type": "force", "z_N": -1},
                              "initial": {"position_m": [0, 0, )") +
                              (name == std::string("press") ? "0.0001" : "0.0003") + "]}}");
    }
  }
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  ProgramRun compare(const std::string& out, const Words& more = {}) const {
    Words words = {"compare", file("press.json"), file("poke.json"),      "--out",
                   file(out), "--algorithms",     "mean, summation,proxy"};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(CompareBatch, ShowsALeagueWithinAHundredColumns) {
  const ProgramRun run = compare("out", {"--by", "force_max_N,depth_max_m"});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* text : {"A  press\n", "B  poke\n", "\nforce_max_N, less is better\n", "\ndepth_max_m, less",
                           "\nall metrics and scenarios\n", "one seed: no spread is known", "results in "}) {
    EXPECT_NE(run.out.find(text), std::string::npos) << text << run.out;
  }
  for (const std::string& line : lines_of(run.out)) {
    if (line.starts_with("results in")) continue;  // the path is the test's
    EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST_F(CompareBatch, TakesTheNameOfAGroupAndRanksByFidelityWhereTheIdealForceIsKnown) {
  const ProgramRun run = hapbench({"compare", "quality", "--algorithms", "mean,proxy", "--out", file("out")});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* text : {"cone_in_cone\n", "two_walls\n", "\nfidelity.force_error_relative, less is better\n",
                           "\nfidelity.force_artefact_share, less is better\n"}) {
    EXPECT_NE(run.out.find(text), std::string::npos) << text << run.out;
  }
}

TEST_F(CompareBatch, KeepsEachRunInAFolderOfItsOwn) {
  compare("out", {"--seeds", "2", "--quiet"});
  for (const char* name : {"league.csv", "press/comparison.csv", "poke/comparison.csv",
                           "press/mean/seed_0/summary.json", "poke/proxy/seed_1/trajectory.csv"}) {
    EXPECT_TRUE(fs::exists(directory_ / "out" / name)) << name;
  }
  const auto lines = lines_of(test::read_file(directory_ / "out/poke/comparison.csv"));
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_EQ(lines[0].find("seed,algorithm,outcome,"), 0u);
  EXPECT_EQ(lines[2].find("1,mean,completes,"), 0u) << lines[2];
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/league.csv")).size(), 1u + 2 * 3 * 3);
}

TEST_F(CompareBatch, GivesTheSameBytesWhateverTheJobs) {
  compare("one", {"--seeds", "2", "--jitter", "1e-5", "--jobs", "1"});
  compare("three", {"--seeds", "2", "--jitter", "1e-5", "--jobs", "3"});
  test::expect_same_files(directory_ / "one", directory_ / "three");
}

TEST_F(CompareBatch, SaysThatNothingIsRandomAndOffersJitter) {
  const std::string alike = compare("out", {"--seeds", "3", "--by", "force_max_N"}).out;
  EXPECT_NE(alike.find("nothing is random in A B: all seeds are one run"), std::string::npos) << alike;
  EXPECT_NE(alike.find("--jitter METRES"), std::string::npos);
  const ProgramRun shifted = compare("out", {"--seeds", "3", "--by", "force_max_N", "--jitter", "2e-5", "--json"});
  for (const Json& row : shifted.json()["standings"]) EXPECT_GT(row["spread"], 0.0) << row;
  EXPECT_EQ(shifted.json()["runs"].size(), 18u);
}

TEST_F(CompareBatch, GoesOnAfterADivergence) {
  const ProgramRun run = hapbench({"compare", file("press.json"), "springs_unlimited_shaped_stiffness", "--out",
                                   file("out"), "--algorithms", "summation,shaped_stiffness", "--json"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(lines_of(run.err).back().find("1 of 4 runs diverge, the first: "), std::string::npos) << run.err;
  const Json json = run.json();
  EXPECT_EQ(json["runs"].size(), 4u);
  const auto summation = std::find_if(json["laws"].begin(), json["laws"].end(),
                                      [](const Json& law) { return law["algorithm"] == "summation"; });
  // The press throws its tool out with the sum of all springs.
  EXPECT_EQ((*summation)["fails"], Json({"press", "springs_unlimited_shaped_stiffness"}));
}

TEST_F(CompareBatch, LeavesNothingOfAnEarlierOne) {
  compare("out", {"--quiet"});
  test::write_plainly(directory_ / "out/mine.txt", "mine");
  hapbench({"compare", file("press.json"), "--out", file("out"), "--algorithms", "proxy", "--quiet"});
  const Words names = test::names_below(directory_ / "out");
  for (const std::string& name : names) {
    EXPECT_TRUE(name.starts_with("proxy/") || name == "comparison.csv" || name == "mine.txt" ||
                name == "hapbench_results.json")
        << name;
  }
  EXPECT_TRUE(fs::exists(directory_ / "out/mine.txt"));
}

TEST_F(CompareBatch, IsAloneInTakingAwayEarlierResults) {
  hapbench({"run", file("press.json"), file("poke.json"), "--out", file("out"), "--quiet"});
  hapbench({"run", file("poke.json"), "single_spring", "--out", file("out"), "--quiet"});
  EXPECT_TRUE(fs::exists(directory_ / "out/press/summary.json")) << "one folder may gather the runs of many commands";
}

TEST_F(CompareBatch, TellsWhatIsWrongBeforeAnythingRuns) {
  test::write_plainly(directory_ / "bad.json", R"({"time": {"step_s": 1, "stepps": 2}})");
  for (const Words& more : {Words{file("bad.json")}, Words{file("press.json")}, Words{"--by", "force_mix_N"},
                            Words{"--jitter=-1"}, Words{"--seeds", "0"}, Words{"--algorithms", "MEAN"}}) {
    const ProgramRun run = compare("out", more);
    EXPECT_EQ(run.status, 2) << more[0];
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(fs::exists(directory_ / "out")) << more[0];
  }
  EXPECT_NE(compare("out", {"--by", "force_mix_N"}).err.find("nearest valid name: \"force_max_N\""), std::string::npos);
  EXPECT_NE(compare("out", {file("bad.json")}).err.find("bad.json"), std::string::npos);
}

}  // namespace
}  // namespace hapbench::compare_batch_test
