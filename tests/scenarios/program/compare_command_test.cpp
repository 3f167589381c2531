#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::compare_command_test {
namespace {

namespace fs = std::filesystem;
using test::cells_of;
using test::hapbench;
using test::lines_of;
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

TEST_F(CompareCommand, ShowsARowForEachAlgorithm) {
  const ProgramRun run = compare({"--algorithms", "original_averaging,mean,exact_shaping"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto lines = lines_of(run.out);
  ASSERT_EQ(lines.size(), 15u) << run.out;
  EXPECT_EQ(lines[0], "peg_in_hole_2d_shaped_stiffness");
  EXPECT_EQ(lines[3].find("algorithm          outcome"), 0u);
  EXPECT_EQ(lines[5].find("original_averaging leaves_hole"), 0u);
  EXPECT_EQ(lines[6].find("mean               leaves_hole"), 0u);
  EXPECT_EQ(lines[7].find("exact_shaping      leaves_hole"), 0u);
  EXPECT_EQ(lines[9],
            "\"-\": under 1/30 s of settled contact (original_averaging); --set metrics.from_s=0 takes all contact");
  EXPECT_EQ(lines[11].find("99 % of the steps take at most "), 0u) << lines[11];
  EXPECT_EQ(lines[12], "defined with a depth model of their own: original_averaging with shortest_distance");
}

TEST_F(CompareCommand, ShowsAllAlgorithmsIn100Columns) {
  for (const std::string& line : lines_of(compare({}).out)) {
    EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST_F(CompareCommand, NamesTheAlgorithmsWhoseFrictionTheIntegratorCannotStep) {
  EXPECT_EQ(
      compare({"--algorithms", "mean,summation,tandpasta"}).err,
      "hapbench: warning: peg_in_hole_2d_shaped_stiffness: beyond 79.5 N of spring force, in 2 of 5 rows, "
      "first in step 0, the explicit step of friction is unstable; what follows is the integrator's doing, not the "
      "law's (summation; likewise tandpasta)\n");
  EXPECT_EQ(compare({"--algorithms", "mean"}).err, "");
  const std::string implicit = compare({"--algorithms", "summation", "--set", "integrator.type=implicit_euler"}).err;
  EXPECT_EQ(implicit.find("friction"), std::string::npos) << implicit;
}

TEST_F(CompareCommand, SaysWhySettledContactHasNoMetrics) {
  const std::string why = "\"-\": under 1/30 s of settled contact (mean)";
  EXPECT_NE(compare({"--algorithms", "mean", "--set", "time.steps=50"}).out.find(why), std::string::npos);
  EXPECT_EQ(compare({"--algorithms", "mean", "--set", "time.steps=100", "--set", "metrics.from_s=0"}).out.find("\"-\""),
            std::string::npos);
}

TEST_F(CompareCommand, WritesTheFilesOfEachSideBySideAndTheTable) {
  compare({"--algorithms", "mean,summation"});
  for (const char* algorithm : {"mean", "summation"}) {
    for (const char* file : {"summary.json", "trajectory.csv", "scenario.effective.json", "ratios.csv"}) {
      EXPECT_TRUE(fs::exists(directory_.path() / "out" / algorithm / file)) << algorithm << file;
    }
  }
  const auto lines = lines_of(test::read_file(directory_ / "out/comparison.csv"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(
      lines[0],
      "algorithm,outcome,steps,force_max_N,velocity_total_variation_m_per_s,force_reversals,"
      "vibration_power_above_30Hz_m2_per_s2,depth_max_m,ratio_min,ratio_max,steps_in_contact,contact_share,landings,"
      "landing_force_max_N,landing_force_step_max_N,settled_s,force_mean_in_contact_N,settled_force_max_N,"
      "force_step_p99_N,settled_force_step_max_N,force_rms_above_30Hz_N,force_reversals_per_s,reduction_changes,"
      "reduction_force_step_max_N");
  // The numbers are those of the summary.
  const Json summary = Json::parse(test::read_file(directory_ / "out/mean/summary.json"));
  const Json& metrics = summary["metrics"];
  const auto cells = cells_of(lines[1]);
  EXPECT_EQ(cells[0], "mean");
  EXPECT_EQ(cells[1], summary["outcome"]);
  EXPECT_EQ(cells[2], std::to_string(summary["steps"].get<int>()));
  const auto names = cells_of(lines[0]);
  ASSERT_EQ(cells.size(), names.size());
  for (std::size_t i = 3; i < names.size(); ++i) {
    const Json& metric = metrics.at(names[i]);
    const auto number = metric.is_null() ? std::nullopt : std::optional(metric.get<double>());
    EXPECT_EQ(cells[i].empty() ? std::nullopt : std::optional(test::number_in(cells[i])), number) << names[i];
  }
}

TEST_F(CompareCommand, EqualsARunOfEachAlgorithmAlone) {
  compare({"--algorithms", "mean"});
  hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--set", "rendering.algorithm=mean", "--out",
            (directory_ / "run").string()});
  // The run misses the expectations of another algorithm, which compare does not ask about; the numbers are the same.
  test::expect_same_files(directory_ / "out/mean", directory_ / "run", {"summary.json"});
}

TEST_F(CompareCommand, GivesTheSameBytesTwice) {
  compare({"--algorithms", "mean,tandpasta"});
  const auto first = test::files_below(out_);
  compare({"--algorithms", "mean,tandpasta"});
  EXPECT_EQ(test::files_below(out_), first);
}

TEST_F(CompareCommand, TakesOverridesJsonAndQuiet) {
  const Json json = compare({"--algorithms", "mean,summation", "--set", "time.steps=3", "--json"}).json();
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["algorithm"], "mean");
  EXPECT_EQ(json[1]["steps"], 3);
  const ProgramRun quiet = compare({"--algorithms", "mean", "--quiet"});
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(CompareCommand, RunsAllAlgorithmsUnlessSomeAreNamed) {
  const Json json = compare({"--set", "time.steps=3", "--json"}).json();
  ASSERT_EQ(json.size(), algorithms().size());
  for (std::size_t i = 0; i < json.size(); ++i) EXPECT_EQ(json[i]["algorithm"], algorithms()[i].info->name);
}

TEST_F(CompareCommand, ExitsWith3WhenOneDivergesUnexpectedly) {
  const ProgramRun run = hapbench(
      {"compare", "springs_unlimited_shaped_stiffness", "--algorithms", "shaped_stiffness,summation", "--out", out_});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("summation diverges at step "), std::string::npos) << run.err;
  EXPECT_EQ(lines_of(run.err).size(), 1u);
}

TEST_F(CompareCommand, RefusesUnknownAlgorithmsBeforeAnythingIsWritten) {
  const ProgramRun run = compare({"--algorithms", "mean,sumation"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("got \"sumation\"; allowed: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("nearest valid name: \"summation\""), std::string::npos);
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CompareCommand, RefusesOneAlgorithmTwice) {
  // The second would overwrite the files of the first.
  EXPECT_EQ(compare({"--algorithms", "mean,mean"}).status, 2);
}

}  // namespace
}  // namespace hapbench::compare_command_test
