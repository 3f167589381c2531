#include "scenarios/batch/run_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/batch/result_folders.hpp"
#include "scenarios/input/input_error.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::run_difference_test {
namespace {

namespace fs = std::filesystem;
using test::input_error_of;
using Names = std::vector<std::string>;

/// Two folders a and b with a run each.
class Differences : public testing::Test {
 protected:
  Differences() {
    for (const char* run : {"a", "b"}) {
      write(run, "scenario.effective.json", R"({"seed": 1, "rendering": {"stiffness_N_per_m": 20000}})");
      write(run, "summary.json", kSummary);
      write(run, "trajectory.csv", "t_s,fx_N\n0,1\n0.5,-2\n1,4\n");
    }
  }
  void write(const std::string& run, const std::string& name, const std::string& text) const {
    fs::create_directories(directory_ / run);
    test::write_plainly(directory_ / run / name, text);
  }
  RunDifference difference() const { return compare_runs(directory_ / "a", directory_ / "b"); }
  static constexpr const char* kSummary =
      R"({"name": "x", "outcome": "completes", "steps": 3, "metrics": {"force_max_N": 4, "ratio_min": null},
          "passivity": {"energy_end_J": 0.5}, "state_hash": "ab", "work": {"queries": 3},
          "provenance": {"commit": "1"}})";
  test::TemporaryDirectory directory_;
};

TEST_F(Differences, OfProvenanceAndWorkDoNotCount) {
  write("b", "summary.json",
        R"({"name": "y", "outcome": "completes", "steps": 3, "metrics": {"force_max_N": 4, "ratio_min": null},
            "passivity": {"energy_end_J": 0.5}, "state_hash": "ab", "work": {"queries": 9},
            "provenance": {"commit": "2"}})");
  EXPECT_FALSE(difference().is_beyond(0.0));
}

TEST_F(Differences, OfFieldsAreToldAndDoNotCount) {
  write("b", "scenario.effective.json", R"({"seed": 2, "rendering": {"stiffness_N_per_m": 20000, "new": true}})");
  const RunDifference d = difference();
  ASSERT_EQ(d.fields.size(), 2u);
  EXPECT_EQ(d.fields[0].name, "seed");
  EXPECT_EQ(d.fields[0].values.a, "1");
  EXPECT_EQ(d.fields[0].values.b, "2");
  EXPECT_EQ(d.fields[1].name, "rendering.new");
  EXPECT_FALSE(d.is_beyond(0.0));
}

TEST_F(Differences, OfFilesAreThoseOfTheirContents) {
  test::write_plainly(directory_ / "mesh.obj", "v 1");
  write("b", "copy.obj", "v 1");
  write("a", "scenario.effective.json", R"({"environment": {"file": "../mesh.obj"}})");
  write("b", "scenario.effective.json", R"({"environment": {"file": "copy.obj"}})");
  EXPECT_TRUE(difference().fields.empty());
  write("b", "copy.obj", "v 2");
  ASSERT_EQ(difference().fields.size(), 1u);
  EXPECT_EQ(difference().fields[0].name, "environment.file");
}

TEST_F(Differences, OfMetricsAreRelativeToTheLarger) {
  write("b", "summary.json",
        R"({"outcome": "completes", "steps": 3, "metrics": {"force_max_N": 5, "ratio_min": 1, "more": 1},
            "passivity": {"energy_end_J": 0.5}, "state_hash": "cd"})");
  const RunDifference d = difference();
  ASSERT_EQ(d.metrics.size(), 2u);
  EXPECT_EQ(d.metrics[0].name, "force_max_N");
  EXPECT_EQ(d.metrics[0].values.relative, 0.2);
  EXPECT_EQ(d.metrics[1].name, "ratio_min");
  EXPECT_TRUE(std::isinf(d.metrics[1].values.relative)) << "a value and none";
  EXPECT_EQ(d.unshared, Names{"> more"});
  EXPECT_TRUE(d.is_beyond(10.0));
}

TEST_F(Differences, WithinTheToleranceCountAsEqual) {
  write("b", "summary.json",
        R"({"outcome": "completes", "steps": 3, "metrics": {"force_max_N": 5, "ratio_min": null},
            "passivity": {"energy_end_J": 0.5}, "state_hash": "cd"})");
  EXPECT_TRUE(difference().is_beyond(0.0));
  EXPECT_TRUE(difference().is_beyond(0.199));
  EXPECT_FALSE(difference().is_beyond(0.2)) << "and the hash, which differs for any difference, does not count";
}

TEST_F(Differences, OfOutcomesCountWhateverTheTolerance) {
  std::string text = kSummary;
  text.replace(text.find("completes"), 9, "diverges!");
  write("b", "summary.json", text);
  EXPECT_TRUE(difference().is_beyond(1e9));
}

TEST_F(Differences, OfLengthCountWhateverTheTolerance) {
  write("b", "trajectory.csv", "t_s,fx_N\n0,1\n0.5,-2\n");
  const RunDifference d = difference();
  EXPECT_EQ(d.trajectory->rows_a, 3u);
  EXPECT_EQ(d.trajectory->rows_b, 2u);
  EXPECT_TRUE(d.is_beyond(1.0));
  fs::remove(directory_ / "b/trajectory.csv");
  EXPECT_TRUE(difference().trajectory_missing);
  EXPECT_TRUE(difference().is_beyond(1.0));
}

TEST_F(Differences, OfColumnsCountWhateverTheTolerance) {
  for (const char* text :
       {"t_s,fx_N,new\n0,1,7\n0.5,-2,7\n1,4,7\n", "t_s\n0\n0.5\n1\n", "fx_N,t_s\n1,0\n-2,0.5\n4,1\n"}) {
    write("b", "trajectory.csv", text);
    const RunDifference d = difference();
    EXPECT_FALSE(d.trajectory->first) << "the columns that both have are the same";
    EXPECT_TRUE(d.is_beyond(0.0)) << text;
    EXPECT_TRUE(d.is_beyond(1.0)) << text;
  }
  EXPECT_TRUE(difference().trajectory->reordered);
}

TEST_F(Differences, OfMetricsAndWarningsThatOneAloneHasCount) {
  write("b", "summary.json",
        R"({"outcome": "completes", "steps": 3, "metrics": {"force_max_N": 4}, "passivity": {"energy_end_J": 0.5},
            "state_hash": "ab", "warnings": ["the tool went through"]})");
  const RunDifference d = difference();
  EXPECT_EQ(d.unshared, (Names{"< ratio_min", "> warning: the tool went through"}));
  EXPECT_TRUE(d.is_beyond(1.0));
}

TEST_F(Differences, OfSignedZeroAreNoneWithinATolerance) {
  write("b", "trajectory.csv", "t_s,fx_N\n-0,1\n0.5,-2\n1,4\n");
  EXPECT_TRUE(difference().is_beyond(0.0));
  EXPECT_FALSE(difference().is_beyond(1e-300));
}

TEST_F(Differences, NeedFilesThatARunWrites) {
  write("b", "summary.json", "[1]");
  EXPECT_NE(std::string(input_error_of([&] { difference(); })->what()).find("b/summary.json: "), std::string::npos);
}

TEST_F(Differences, AreOfPairsByTheirPaths) {
  const test::TemporaryDirectory other;
  for (const char* run : {"a", "c"}) {
    fs::create_directory(other / run);
    test::write_plainly(other / run / "summary.json", "{}");
  }
  test::write_plainly(other / "sweep.csv", "");
  const ResultPairs pairs = pair_results(directory_.path(), other.path());
  EXPECT_EQ(pairs.runs, std::vector<fs::path>{"a"});
  EXPECT_TRUE(pairs.sweeps.empty());
  EXPECT_EQ(pairs.only_in_a, std::vector<fs::path>{"b/summary.json"});
  EXPECT_EQ(pairs.only_in_b, (std::vector<fs::path>{"c/summary.json", "sweep.csv"}));
  EXPECT_EQ(pair_results(directory_ / "a", other / "a").runs, std::vector<fs::path>{""});
}

TEST_F(Differences, NeedFoldersOfResultsWithSomethingInCommon) {
  const test::TemporaryDirectory empty;
  for (const auto& [a, b] :
       {std::pair{directory_ / "a", empty.path()}, std::pair{directory_ / "none", empty.path()},
        std::pair{directory_ / "a/summary.json", directory_ / "a"}, std::pair{directory_ / "a", directory_.path()}}) {
    EXPECT_TRUE(input_error_of([&, &a = a, &b = b] { pair_results(a, b); })) << a << b;
  }
}

}  // namespace
}  // namespace hapbench::run_difference_test
