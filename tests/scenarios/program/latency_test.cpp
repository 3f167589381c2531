#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// `hapbench run --latency` and record.timing.
namespace hapbench::latency_test {
namespace {

using test::hapbench;
using test::lines_of;
using test::ProgramRun;

class Latency : public testing::Test {
 protected:
  std::string out(const std::string& name = "out") const { return (directory_ / name).string(); }
  Json json_file(const std::string& name) const { return Json::parse(test::read_file(directory_ / name)); }

  test::TemporaryDirectory directory_;
};

TEST_F(Latency, TimesEveryStepAndPrintsATable) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out(), "--latency"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto lines = lines_of(run.out);
  ASSERT_EQ(lines.size(), 14u) << run.out;
  for (const char* column : {"steps", "p50 us", "p95 us", "p99 us", "p99.9 us", "max us", "> 0.500 ms", "> 0.488 ms"}) {
    EXPECT_NE(lines[8].find(column), std::string::npos) << column;
  }
  EXPECT_EQ(lines[10].find("single_spring"), 0u);
  EXPECT_EQ(lines[11].find("single_damper"), 0u);
  const Json latency = json_file("out/single_spring/timing.json")["step_latency"];
  EXPECT_EQ(latency["steps"], json_file("out/single_spring/summary.json")["steps"]);
  EXPECT_LE(latency["p50_s"], latency["p95_s"]);
  EXPECT_LE(latency["p99_9_s"], latency["max_s"]);
  EXPECT_GT(latency["max_s"], 0.0);
  std::uint64_t binned = 0;
  for (const Json& bin : latency["histogram"]) binned += bin["steps"].get<std::uint64_t>();
  EXPECT_EQ(binned, latency["steps"]);
}

// Each step of a bin takes at least the bin's lower end.
TEST_F(Latency, StepsTakeNoLongerThanTheLoop) {
  hapbench({"run", "drill_in_hole", "--out", out(), "--latency"});
  const Json timing = json_file("out/timing.json");
  double least = 0.0;
  for (const Json& bin : timing["step_latency"]["histogram"]) {
    least += bin["from_s"].get<double>() * bin["steps"].get<double>();
  }
  EXPECT_LE(least, timing["loop_s"]);
  EXPECT_LE(timing["step_latency"]["max_s"], timing["loop_s"]);
}

TEST_F(Latency, IsPartOfTheJsonAndOfNoOtherFile) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out("a"), "--latency", "--json"});
  EXPECT_EQ(run.json()[0]["step_latency"], json_file("a/timing.json")["step_latency"]);
  EXPECT_FALSE(json_file("a/summary.json").contains("step_latency"));
  // The same as a scenario that says so itself; but for times, the results are those without.
  hapbench({"run", "single_spring", "--out", out("b"), "--set", "record.timing=true"});
  test::expect_same_files(directory_ / "a", directory_ / "b", {"timing.json"});
  hapbench({"run", "single_spring", "--out", out("c")});
  EXPECT_EQ(test::read_file(directory_ / "a/trajectory.csv"), test::read_file(directory_ / "c/trajectory.csv"));
}

TEST_F(Latency, RefusesMoreStepsThanItKeeps) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out(), "--latency", "--set", "time.steps=30000000",
                                   "--set", "record.trajectory=false"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("/record/timing: got 3e+07 timed steps; allowed: at most 2e+07"), std::string::npos)
      << run.err;
  EXPECT_EQ(lines_of(run.err).size(), 1u);
  EXPECT_TRUE(test::names_below(directory_.path()).empty());
}

}  // namespace
}  // namespace hapbench::latency_test
