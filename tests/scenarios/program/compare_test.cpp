#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench compare: of algorithms, of scenarios and seeds. What it prints is in tests/data/golden/sweep.txt, its
/// numbers are in tests/known_answers.
namespace hapbench::compare_test {
namespace {

using test::hapbench;

class CompareCommand : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return (directory_ / name).string(); }

  test::TemporaryDirectory directory_;
};

TEST_F(CompareCommand, EqualsARunOfEachAlgorithmAlone) {
  const std::string scene = "peg_in_hole_2d_shaped_stiffness";
  hapbench({"compare", scene, "--algorithms", "mean", "--out", at("out")});
  hapbench({"run", scene, "--set", "rendering.algorithm=mean", "--out", at("run")});
  // The run misses the expectations of another algorithm, which compare does not ask about; the numbers are the same.
  test::expect_same_files(directory_ / "out/mean", directory_ / "run", {"summary.json"});
}

/// A round tip pressed onto a plane, from two heights.
TEST_F(CompareCommand, GivesTheSameBytesWhateverTheJobs) {
  for (const auto& [name, height] : {std::pair{"press", "0.0001"}, {"poke", "0.0003"}}) {
    test::write_plainly(directory_ / (std::string(name) + ".json"),
                        std::string(R"({"time": {"step_s": 0.0005, "steps": 100}, "tool": {"tip": "round"},
                        "environment": {"type": "plane"}, "hand": {"type": "force", "z_N": -1},
                        "initial": {"position_m": [0, 0, )") +
                            height + "]}}");
  }
  for (const char* jobs : {"1", "5"}) {
    hapbench({"compare", at("press.json"), at("poke.json"), "--algorithms", "mean, summation,proxy", "--seeds", "2",
              "--jitter", "1e-5", "--jobs", jobs, "--quiet", "--out", at(jobs)});
  }
  for (const char* name :
       {"league.csv", "press/comparison.csv", "poke/comparison.csv", "poke/proxy/seed_1/summary.json"})
    EXPECT_TRUE(std::filesystem::exists(directory_ / "1" / name)) << name;
  test::expect_same_files(directory_ / "1", directory_ / "5");
}

}  // namespace
}  // namespace hapbench::compare_test
