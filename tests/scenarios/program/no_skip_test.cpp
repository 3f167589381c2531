#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// `--no-skip` of `run` and `compare`; that results are the same for every scenario:
/// tests/scenarios/run/skips_test.cpp.
namespace hapbench::no_skip_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;

Json summary(const fs::path& directory) {
  return Json::parse(test::read_file(directory / "summary.json"));
}

TEST(NoSkip, TurnsEverySkipOffAndChangesNoResult) {
  const test::TemporaryDirectory directory;
  const std::string with = (directory / "with").string(), without = (directory / "without").string();
  // From free air.
  const std::string start = "initial.position_m=[0,0,0.002]";
  EXPECT_EQ(hapbench({"run", "poke_plane", "--set", start, "--out", with}).status, 0);
  EXPECT_EQ(hapbench({"run", "poke_plane", "--set", start, "--out", without, "--no-skip"}).status, 0);
  test::expect_same_files(with, without, {"summary.json"});
  const Json skipping = summary(with), computing = summary(without);
  EXPECT_EQ(skipping["state_hash"], computing["state_hash"]);
  EXPECT_EQ(skipping["provenance"], computing["provenance"]);
  EXPECT_GT(skipping["work"]["steps_skipped"], 0);
  EXPECT_EQ(computing["work"]["steps_skipped"], 0);
  EXPECT_EQ(computing["work"]["lists_rebuilt"], 0);
  EXPECT_GT(computing["work"]["points_tested"], skipping["work"]["points_tested"]);
}

TEST(NoSkip, ComparesTheSame) {
  const test::TemporaryDirectory directory;
  const std::string with = (directory / "with").string(), without = (directory / "without").string();
  const std::vector<std::string> compare = {"compare", "poke_plane", "--algorithms", "mean,exact_shaping", "--out"};
  std::vector<std::string> skipping = compare, computing = compare;
  skipping.push_back(with);
  computing.insert(computing.end(), {without, "--no-skip"});
  EXPECT_EQ(hapbench(skipping).status, 0);
  EXPECT_EQ(hapbench(computing).status, 0);
  test::expect_same_files(with, without, {"summary.json"});
}

}  // namespace
}  // namespace hapbench::no_skip_test
