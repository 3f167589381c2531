#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::diff_command_test {
namespace {

using test::hapbench;
using test::ProgramRun;
using Words = std::vector<std::string>;

class DiffCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  void run(const std::string& out, const Words& more = {}) const {
    Words words = {"run", "peg_in_hole_2d_shaped_stiffness", "--quiet", "--out", path(out)};
    words.insert(words.end(), more.begin(), more.end());
    hapbench(words);
  }
  ProgramRun diff(const std::string& a, const std::string& b, const Words& more = {}) const {
    Words words = {"diff", path(a), path(b)};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(DiffCommand, ShowsFieldsResultsAndWhereTheTrajectoriesPart) {
  run("a");
  run("b", {"--set", "rendering.stiffness_N_per_m=20002"});
  const ProgramRun changed = diff("a", "b");
  EXPECT_EQ(changed.status, 3);
  for (const char* text :
       {"rendering.stiffness_N_per_m  20000  20002", "force_max_N", "state hash: ", "trajectory.csv: ", "not equal"}) {
    EXPECT_NE(changed.out.find(text), std::string::npos) << text << changed.out;
  }
  const Json json = diff("a", "b", {"--json"}).json();
  EXPECT_EQ(json["equal"], false);
  EXPECT_EQ(json["runs"]["."]["fields"]["rendering.stiffness_N_per_m"]["b"], "20002");
  EXPECT_GT(json["runs"]["."]["results"]["force_max_N"]["relative"], 0.0);
  EXPECT_EQ(json["runs"]["."]["trajectory"]["first"]["row"], 0);
}

TEST_F(DiffCommand, PairsTheRunsOfComparisonsAndTheRowsOfSweeps) {
  for (const char* out : {"a", "b"}) {
    hapbench({"compare", "peg_in_hole_2d_shaped_stiffness", "--algorithms",
              out == std::string("a") ? "mean,summation" : "mean,proxy", "--quiet", "--out", path(out)});
    hapbench({"sweep", "single_spring", "--vary", "rendering.stiffness_N_per_m=100,200", "--set",
              out == std::string("a") ? "initial.position_m=[0.005,0,0]" : "initial.position_m=[0.006,0,0]", "--quiet",
              "--out", path(out) + "/sweep"});
  }
  const ProgramRun run = diff("a", "b", {"--json"});
  EXPECT_EQ(run.status, 3);
  const Json json = run.json();
  ASSERT_EQ(json["runs"].size(), 1u);
  EXPECT_EQ(json["runs"]["mean"]["results"], Json::object());
  EXPECT_EQ(json["only_in_a"], Json({"summation/summary.json"}));
  EXPECT_EQ(json["only_in_b"], Json({"proxy/summary.json"}));
  EXPECT_EQ(json["sweeps"]["sweep/sweep.csv"]["rows"], Json({2, 2}));
  EXPECT_TRUE(json["sweeps"]["sweep/sweep.csv"]["columns"].contains("force_max_N"));
}

TEST_F(DiffCommand, RefusesWhatIsNoRun) {
  run("a");
  for (const Words& words :
       {Words{"none"}, Words{"a/summary.json"}, Words{"a", "--tolerance=-1"}, Words{"a", "--tolerance", "nan"}}) {
    const ProgramRun refused = diff("a", words[0], {words.begin() + 1, words.end()});
    EXPECT_EQ(refused.status, 2) << words[0];
    EXPECT_EQ(refused.out, "");
    EXPECT_EQ(test::lines_of(refused.err).size(), 1u) << refused.err;
  }
}

}  // namespace
}  // namespace hapbench::diff_command_test
