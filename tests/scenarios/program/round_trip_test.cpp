#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// scenario.effective.json reproduces the run it lies beside; those of the bundled scenarios are tested in
/// bundled_scenarios_test.cpp.
namespace hapbench::round_trip_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;

/// Runs `scenario`, then the effective scenario of that run, and compares all files.
void expect_reproduced(const std::string& scenario, const fs::path& directory, const std::string& first,
                       const std::string& second, const std::vector<std::string>& ignored) {
  const test::ProgramRun run = hapbench({"run", scenario, "--out", (directory / first).string()});
  ASSERT_EQ(run.status, 0) << run.err;
  const test::ProgramRun again = hapbench(
      {"run", (directory / first / "scenario.effective.json").string(), "--out", (directory / second).string()});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, run.err);  // warnings about the run
  test::expect_same_files(directory / first, directory / second, ignored);
}

/// Scenarios with files, records of every kind and odd settings, in a directory of their own.
class EffectiveScenarioWithFiles : public testing::Test {
 protected:
  EffectiveScenarioWithFiles() {
    fs::create_directories(directory_ / "my scenes");
    for (const char* file : {"cube.obj", "shell.csv", "stroke.csv"}) {
      fs::copy_file(test::data_directory() / file, directory_.path() / "my scenes" / file);
    }
  }
  std::string write(const test::NamedScenario& scenario) const {
    const fs::path file = directory_.path() / "my scenes" / (scenario.name + ".json");
    test::write_plainly(file, scenario.json.dump());
    return file.string();
  }
  test::TemporaryDirectory directory_;
};

TEST_F(EffectiveScenarioWithFiles, ReproducesTheRunFromADirectoryOfTheSameDepth) {
  for (const test::NamedScenario& scenario : test::rich_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_reproduced(write(scenario), directory_.path(), "a_" + scenario.name, "b_" + scenario.name, {"timing.json"});
  }
}

TEST_F(EffectiveScenarioWithFiles, ReproducesTheRunFromAnotherDirectory) {
  // Its paths are then written differently; everything else is the same, the hash of the scenario included.
  for (const test::NamedScenario& scenario : test::rich_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_reproduced(write(scenario), directory_.path(), "first/" + scenario.name, "b/deeper/still/" + scenario.name,
                      {"timing.json", "scenario.effective.json"});
  }
}

TEST_F(EffectiveScenarioWithFiles, ReproducesTheRunThroughALinkedOutputDirectory) {
  fs::create_directories(directory_ / "disk/deep/results");
  fs::create_directory_symlink(directory_ / "disk/deep/results", directory_ / "link");
  for (const test::NamedScenario& scenario : test::rich_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_reproduced(write(scenario), directory_.path(), "link/" + scenario.name, "b_" + scenario.name,
                      {"timing.json", "scenario.effective.json"});
  }
}

TEST_F(EffectiveScenarioWithFiles, StillMeansTheSameWhenTheDirectoryMovesAsAWhole) {
  const fs::path before = directory_ / "project", after = directory_ / "elsewhere/project";
  fs::create_directories(before);
  fs::create_directories(directory_ / "elsewhere");
  fs::rename(directory_ / "my scenes", before / "scenes");
  const test::NamedScenario scenario = test::rich_scenarios()[2];
  ASSERT_EQ(scenario.name, "recorded_shell");
  test::write_plainly(before / "scenes/s.json", scenario.json.dump());
  ASSERT_EQ(hapbench({"run", (before / "scenes/s.json").string(), "--out", (before / "out").string()}).status, 0);
  fs::rename(before, after);
  const test::ProgramRun run =
      hapbench({"run", (after / "out/scenario.effective.json").string(), "--out", (after / "again").string()});
  ASSERT_EQ(run.status, 0) << run.err;
  test::expect_same_files(after / "out", after / "again");
}

}  // namespace
}  // namespace hapbench::round_trip_test
