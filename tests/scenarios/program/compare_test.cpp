#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench compare: of algorithms, of scenarios and seeds. What it prints is in tests/data/golden/sweep.txt.
namespace hapbench::compare_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using test::hapbench;
using test::ProgramRun;

class CompareCommand : public testing::Test {
 protected:
  ProgramRun compare(std::vector<std::string> more) const {
    more.insert(more.begin(), {"compare", "peg_in_hole_2d_shaped_stiffness", "--out", out_});
    return hapbench(more);
  }
  test::TemporaryDirectory directory_;
  std::string out_ = (directory_ / "out").string();
};

TEST_F(CompareCommand, EqualsARunOfEachAlgorithmAlone) {
  compare({"--algorithms", "mean"});
  hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--set", "rendering.algorithm=mean", "--out",
            (directory_ / "run").string()});
  // The run misses the expectations of another algorithm, which compare does not ask about; the numbers are the same.
  test::expect_same_files(directory_ / "out/mean", directory_ / "run", {"summary.json"});
}

/// A bur along a molar's fissure, its points 0.25 mm apart: summation, whose stiffness grows with the number of points,
/// is the smoothest there and hammers at half of that.
TEST_F(CompareCommand, SaysThatTheSamplingMakesTheWinner) {
  const Json json = hapbench({"compare", "bur_fissure", "--set", "environment.spacing_m=0.00025", "--algorithms",
                              "shaped_stiffness,summation", "--out", out_, "--errors", "--json"})
                        .json();
  ASSERT_EQ(json["errors"].size(), 9u) << "the numbers of the printed table";
  for (const Json& row : json["errors"]) {
    EXPECT_EQ(row["order"].size(), row["says"].get<std::string>().starts_with("the order holds") ? 2u : 1u) << row;
    EXPECT_EQ(row["numbers"][0]["value"], json["runs"][0]["metrics"][row["metric"]]);
    if (row["metric"] == "force_step_p99_N") {
      EXPECT_EQ(row["says"], "no order holds: summation ~ shaped_stiffness");
    }
  }
}

/// Comparisons of several scenarios or seeds.
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

TEST_F(CompareBatch, GivesTheSameBytesWhateverTheJobs) {
  for (const char* jobs : {"1", "5"}) compare(jobs, {"--seeds", "2", "--jitter", "1e-5", "--jobs", jobs, "--quiet"});
  for (const char* name :
       {"league.csv", "press/comparison.csv", "poke/comparison.csv", "poke/proxy/seed_1/summary.json"})
    EXPECT_TRUE(fs::exists(directory_ / "1" / name)) << name;
  test::expect_same_files(directory_ / "1", directory_ / "5");
}

TEST_F(CompareBatch, SpreadsWithJitter) {
  const Json json = compare("out", {"--seeds", "3", "--by", "force_max_N", "--jitter", "2e-5", "--json"}).json();
  for (const Json& row : json["standings"]) {
    if (row["failed"] == 0)
      EXPECT_GT(row["spread"], 0.0) << row;
    else
      EXPECT_TRUE(row["spread"].is_null()) << row;  // the sum of all springs throws the tool out
  }
  EXPECT_EQ(json["runs"].size(), 18u);
}

}  // namespace
}  // namespace hapbench::compare_test
