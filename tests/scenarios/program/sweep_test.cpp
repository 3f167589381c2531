#include <gtest/gtest.h>

#include <fstream>

#include "scenarios/format/text_lines.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench sweep: what a sweep computes, writes and shows, whole and in shards.
namespace hapbench::sweep_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using test::cells_of;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using test::read_file;

class SweepCommand : public testing::Test {
 protected:
  /// 24 runs in four environments, some of which end early.
  Words words(const std::string& out) const {
    const std::string line =
        "peg_in_hole_2d_shaped_stiffness --set expect.metrics={} "
        R"(--set expect.outcome=["completes","leaves_hole","lost_contact","diverges"] )"
        "--vary rendering.stiffness_N_per_m=5000:20000:2 --vary environment.spacing_m=2e-5:5e-5:4:log "
        "--vary rendering.algorithm=mean,summation,exact_shaping --out";
    Words words;
    for (const std::string_view word : words_of(line)) words.emplace_back(word);
    words.push_back((directory_ / out).string());
    return words;
  }
  ProgramRun sweep(const std::string& out, const Words& more = {}) const {
    Words all = words(out);
    all.insert(all.begin(), "sweep");
    all.insert(all.end(), more.begin(), more.end());
    return hapbench(all);
  }
  std::string table(const std::string& out) const { return read_file(directory_ / out / "sweep.csv"); }
  test::TemporaryDirectory directory_;
};

/// A disk that is full, as far as the sweep can see: a file stands where the folder of a run should be.
TEST_F(SweepCommand, StartsNoFurtherRunsWhereTheyCannotBeKept) {
  fs::create_directories(directory_ / "a" / "runs");
  std::ofstream(directory_ / "a" / "runs" / "000000") << "in the way";
  const ProgramRun stopped = sweep("a", {"--keep-runs", "--jobs", "1"});
  EXPECT_EQ(stopped.status, 1);
  EXPECT_NE(stopped.err.find("000000"), std::string::npos) << stopped.err;
  EXPECT_FALSE(fs::exists(directory_ / "a" / "sweep.csv"));
  EXPECT_FALSE(fs::exists(directory_ / "a" / "runs" / "000001"));
  fs::remove(directory_ / "a" / "runs" / "000000");
  EXPECT_EQ(sweep("a", {"--keep-runs", "--resume"}).status, 0);
  sweep("b");
  EXPECT_EQ(table("a"), table("b"));
}

TEST_F(SweepCommand, HasTheRunsThatThePrintedCommandRepeats) {
  const ProgramRun run = sweep("a", {"--keep-runs", "--jobs", "4"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto lines = lines_of(table("a"));
  ASSERT_EQ(lines.size(), 25u);
  const Words names = cells_of(lines[0]);
  EXPECT_EQ((Words{names.begin(), names.begin() + 7}),
            (Words{"index", "rendering.stiffness_N_per_m", "environment.spacing_m", "rendering.algorithm", "outcome",
                   "expected", "steps"}));
  EXPECT_EQ(names.back(), "state_hash");
  const Words cells = cells_of(lines[1 + 12 + 0 + 2]);
  EXPECT_EQ((Words{cells.begin(), cells.begin() + 4}), (Words{"14", "20000", "2e-05", "exact_shaping"}));

  const ProgramRun printed = sweep("a", {"--row", "14", "--print"});
  EXPECT_EQ(lines_of(printed.out).size(), 1u);
  // As a shell takes it apart: the quotes around the list of outcomes are its own.
  EXPECT_NE(printed.out.find(" --set 'expect.outcome=[\"completes\","), std::string::npos) << printed.out;
  Words words = sweep("a", {"--row", "14", "--print", "--json"}).json()["command"];
  EXPECT_EQ(words[0], fs::canonical(test::hapbench_program()));
  words.erase(words.begin());
  words.insert(words.end(), {"--out", (directory_ / "run").string()});
  ASSERT_EQ(hapbench(words).status, 0);
  // Byte for byte, the counted allocations of a run beside others included; the diagnosis is that of the command alone.
  test::expect_same_files(directory_ / "a/runs/000014", directory_ / "run", {"summary.json"});
  Json summary = Json::parse(read_file(directory_ / "run/summary.json"));
  EXPECT_EQ(summary.erase("diagnosis"), 1u);
  EXPECT_EQ(summary, Json::parse(read_file(directory_ / "a/runs/000014/summary.json")));
  EXPECT_EQ(summary["work"]["allocations"], 0);
  EXPECT_TRUE(fs::exists(directory_ / "a/runs/000023/trajectory.csv"));
  EXPECT_EQ(cells[4], summary["outcome"]);
  EXPECT_EQ(cells[6], std::to_string(summary["steps"].get<int>()));
  EXPECT_EQ(cells.back(), summary["state_hash"]);
}

TEST_F(SweepCommand, IsPrintedAgainFromItsFolder) {
  const std::string out = (directory_ / "a").string();
  for (const Words& vary : {Words{"--vary", "rendering.mass_kg=0.1:0.2:4", "--vary", "seed=1,2"},
                            Words{"--sample", "lhs:16", "--vary", "rendering.mass_kg=0.1:0.2"}}) {
    Words words = {"sweep", "springs_limited_mean", "--set", "expect={}", "--out", out};
    words.insert(words.end(), vary.begin(), vary.end());
    const ProgramRun first = hapbench(words), again = hapbench({"sweep", out});
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_EQ(again.out, first.out);
    EXPECT_EQ(again.err, "");
    words.emplace_back("--json");
    EXPECT_EQ(hapbench({"sweep", out, "--json"}).out, hapbench(words).out);
  }
}

TEST_F(SweepCommand, PrintsTheRunsThatKeepConditions) {
  ASSERT_EQ(sweep("a").status, 0);
  const std::string out = (directory_ / "a").string();
  Json expected = Json::array();
  const Json all = hapbench({"sweep", out, "--json"}).json()["rows"];
  for (const Json& row : all)
    if (row["force_max_N"] < 3.0 && row["rendering.algorithm"] != "mean") expected.push_back(row);
  ASSERT_GT(expected.size(), 1u);
  ASSERT_LT(expected.size(), 16u);
  const Words where = {"--where", "force_max_N<3", "--where", "rendering.algorithm!=mean"};
  Words words = {"sweep", out};
  words.insert(words.end(), where.begin(), where.end());
  // Asked for at once, or of the table: the same.
  const ProgramRun again = hapbench(words), first = sweep("a", where);
  EXPECT_EQ(first.out, again.out);
  const std::string says = " of 24 runs have force_max_N<3 and rendering.algorithm!=mean\n";
  EXPECT_NE(again.out.find(std::to_string(expected.size()) + says), std::string::npos) << again.out;
  words.emplace_back("--json");
  EXPECT_EQ(hapbench(words).json()["rows"], expected);
  EXPECT_EQ(hapbench({"sweep", out, "--vary", "seed=1,2"}).status, 2);
  const auto lines = lines_of(table("a"));
  test::write_plainly(directory_ / "a/sweep.csv", lines[0] + "\n" + lines[2] + "\n0,1,2,3\n");
  EXPECT_NE(hapbench({"sweep", out}).err.find("allowed: rows of this sweep"), std::string::npos);
}

TEST_F(SweepCommand, VariesScenesAndWholeObjects) {
  const std::string devices = R"(device={"type":"ideal"},{"type":"impedance","preset":"touch"})";
  const ProgramRun run =
      hapbench({"sweep", "--vary", "scenario=single_spring,poke_plane", "--vary", devices, "--set", "expect={}",
                "--set", "time.steps=50", "--out", (directory_ / "a").string(), "--json"});
  const Json rows = run.json()["rows"];
  ASSERT_EQ(rows.size(), 4u) << run.err;
  EXPECT_EQ(rows[1]["scenario"], "single_spring");
  EXPECT_EQ(rows[3]["scenario"], "poke_plane");
  EXPECT_EQ(rows[3]["device"]["preset"], "touch");
  EXPECT_NE(rows[0]["state_hash"], rows[2]["state_hash"]);
  EXPECT_EQ(hapbench({"sweep", (directory_ / "a").string(), "--json"}).out, run.out);
}

/// As Slurm would run them: a task for each shard, of which one is given again, and the last joins the tables.
TEST_F(SweepCommand, RunsInShardsByTheScriptForSlurm) {
  const auto task = [&](const std::string& number, Words more) {
    more.insert(more.begin(), {"HAPBENCH=" + test::hapbench_program().string(), "SLURM_ARRAY_TASK_COUNT=3",
                               "SLURM_ARRAY_TASK_ID=" + number, HAPBENCH_SCENARIOS "/../../scripts/sweep.sbatch"});
    return test::run_program("/usr/bin/env", more);
  };
  for (const char* number : {"1", "1", "0", "2"}) {
    EXPECT_FALSE(fs::exists(directory_ / "it's/sweep.csv"));
    const ProgramRun run = task(number, words("it's"));
    EXPECT_EQ(run.status, 0) << run.err;
  }
  sweep("whole");
  for (const char* file : {"sweep.csv", "sweep.json"})
    EXPECT_EQ(read_file(directory_ / "it's" / file), read_file(directory_ / "whole" / file)) << file;
  const ProgramRun homeless = task("0", {"single_spring"});
  EXPECT_EQ(homeless.status, 2);
  EXPECT_NE(homeless.err.find("--out FOLDER is missing"), std::string::npos) << homeless.err;
}

TEST(SweepThreads, ThatCannotAllBeStartedEndItWithAReason) {
  const test::TemporaryDirectory directory;
  // Each has a stack of some megabytes.
  const ProgramRun run =
      hapbench({"sweep", "tap_wall", "--vary", "seed=1:400:400", "--jobs", "200", "--out", directory / "out"},
               {.memory_limit = std::size_t{1} << 30});
  EXPECT_EQ(run.signal, 0);
#ifndef HAPBENCH_SANITIZED  // which reserve more addresses
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("if threads or memory ran short: fewer --jobs"), std::string::npos) << run.err;
#endif
}

/// 16 million points, which are allowed, in less memory than they take.
TEST(Memory, ThatIsNotThereEndsACommandWithAReason) {
#ifdef HAPBENCH_SANITIZED
  GTEST_SKIP() << "sanitizers reserve more addresses";
#endif
  const ProgramRun run =
      hapbench({"run", "poke_plane", "--set", "environment.spacing_m=1e-6"}, {.memory_limit = 500'000'000});
  EXPECT_EQ(run.signal, 0);
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("out of memory; allowed: "), std::string::npos) << run.err;
}

}  // namespace
}  // namespace hapbench::sweep_test
