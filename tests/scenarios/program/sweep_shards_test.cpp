#include "tests/scenarios/program/peg_sweep.hpp"
#include "tests/scenarios/support/file_tree.hpp"

/// A sweep in parts: shards, their merge, their state and their scripts for Slurm.
namespace hapbench::sweep_shards_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using test::read_file;
using Words = std::vector<std::string>;

class SweepShards : public test::PegSweep {};

TEST_F(SweepShards, GiveTheSameBytesHoweverManyWithAnyJobs) {
  sweep("whole");
  const std::string whole = table("whole");
  for (const char* jobs : {"1", "2", "7"}) {
    EXPECT_EQ(sweep(std::string("jobs_") + jobs, {"--jobs", jobs}).status, 0);
    test::expect_same_files(directory_ / "whole", directory_ / (std::string("jobs_") + jobs));
  }
  for (int count = 1; count <= 5; ++count) {
    const std::string n = std::to_string(count), out = "shards_" + n;
    Words merge = {"merge", "--out", (directory_ / out / "all/merged.csv").string()};
    for (int i = count - 1; i >= 0; --i) {
      EXPECT_EQ(sweep(out, {"--shard", std::to_string(i) + "/" + n, "--jobs", std::to_string(1 + i)}).status, 0);
      merge.push_back((directory_ / out / ("sweep_shard_" + std::to_string(i) + "_of_" + n + ".csv")).string());
    }
    const ProgramRun merged = hapbench(merge);
    EXPECT_EQ(merged.status, 0) << merged.err;
    EXPECT_EQ(read_file(directory_ / out / "all/merged.csv"), whole) << count;
  }
}

TEST_F(SweepShards, OfASampleGiveTheSameBytes) {
  const auto sample = [&](const std::string& out, const Words& more) {
    Words words = {"sweep",    "peg_in_hole_2d_shaped_stiffness",
                   "--out",    (directory_ / out).string(),
                   "--set",    "expect.metrics={}",
                   "--vary",   "rendering.stiffness_N_per_m=5000:20000:log",
                   "--vary",   "rendering.algorithm=mean,exact_shaping",
                   "--sample", "lhs:12"};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  };
  const ProgramRun run = sample("whole", {"--jobs", "1"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(lines_of(table("whole")).size(), 13u);
  EXPECT_EQ(Json::parse(read_file(directory_ / "whole/sweep.json"))["sample"],
            (Json{{"method", "lhs"}, {"runs", 12}, {"seed", 1}}));
  sample("two", {"--jobs", "2"});
  test::expect_same_files(directory_ / "whole", directory_ / "two");
  for (const char* shard : {"0/2", "1/2"}) EXPECT_EQ(sample("shards", {"--shard", shard}).status, 0);
  hapbench({"merge", (directory_ / "shards/sweep_shard_0_of_2.csv").string(),
            (directory_ / "shards/sweep_shard_1_of_2.csv").string(), "--out", (directory_ / "merged.csv").string()});
  EXPECT_EQ(read_file(directory_ / "merged.csv"), table("whole"));
  sample("other", {"--seed", "2"});
  EXPECT_NE(table("other"), table("whole"));
}

TEST_F(SweepShards, MayBeMoreThanRuns) {
  Words merge = {"merge", "--out", (directory_ / "merged.csv").string()};
  const auto seeds = [&](const Words& more) {
    Words words = {"sweep", "single_spring", "--vary", "seed=1,2", "--out", directory_.path().string()};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  };
  for (const char* i : {"0", "1", "2"}) {
    EXPECT_EQ(seeds({"--shard", std::string(i) + "/3"}).status, 0);
    merge.push_back((directory_ / ("sweep_shard_" + std::string(i) + "_of_3.csv")).string());
  }
  EXPECT_EQ(hapbench(merge).status, 0);
  seeds({});
  EXPECT_EQ(read_file(directory_ / "merged.csv"), read_file(directory_ / "sweep.csv"));
}

TEST_F(SweepShards, AreMergedOnlyWhenTheyBelongTogether) {
  const auto seeds = [&](const std::string& out, const std::string& vary, const std::string& shard) {
    hapbench({"sweep", "single_spring", "--vary", vary, "--out", (directory_ / out).string(), "--shard", shard});
    return (directory_ / out / ("sweep_shard_" + shard.substr(0, 1) + "_of_2.csv")).string();
  };
  const std::string first = seeds("a", "seed=1,2", "0/2"), other = seeds("b", "seed=1,3", "1/2");
  for (const Words& files : {Words{first}, Words{first, first}, Words{first, other},
                             Words{first, (directory_ / "missing.csv").string()}, Words{directory_.path().string()}}) {
    Words words = {"merge", "--out", (directory_ / "out/merged.csv").string()};
    words.insert(words.end(), files.begin(), files.end());
    const ProgramRun run = hapbench(words);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(lines_of(run.err).size(), 1u) << run.err;
    EXPECT_FALSE(fs::exists(directory_ / "out"));
  }
}

TEST_F(SweepShards, ShowHowFarTheyAre) {
  const auto status = [&] { return hapbench({"sweep", "--status", (directory_ / "out").string(), "--json"}); };
  EXPECT_EQ(status().status, 2) << "there is no such directory";
  ASSERT_EQ(sweep("out", {"--shard", "1/4"}).status, 0);
  {
    // What a killed process leaves.
    test::write_plainly(directory_ / "out/sweep_shard_2_of_4.journal", "title\nrow\nrow\n");
  }
  const Json json = status().json();
  EXPECT_EQ(json["runs"], 24);
  EXPECT_EQ(json["runs_done"], 8);
  EXPECT_EQ(json["merged"], false);
  Words states;
  for (const Json& shard : json["shards"]) states.push_back(shard["state"]);
  EXPECT_EQ(states, (Words{"missing", "done", "failed", "missing"}));
  const ProgramRun shown = hapbench({"sweep", "--status", (directory_ / "out").string()});
  EXPECT_NE(shown.out.find("4 shards: 1 done, 0 running, 0 waiting, 1 failed, 2 missing; 8 of 24 runs; not merged\n"),
            std::string::npos)
      << shown.out;
  sweep("out", {"--shard", "0/3"});
  const ProgramRun mixed = hapbench({"sweep", "--status", (directory_ / "out").string()});
  EXPECT_EQ(mixed.status, 2);
  EXPECT_NE(mixed.err.find("holds shards of several sweeps (of 3 and of 4)"), std::string::npos) << mixed.err;
}

TEST_F(SweepShards, HaveScriptsForSlurmThatADryRunDoesNotSubmit) {
  const Words slurm = {"--slurm", "4", "--dry-run", "--time", "2:00:00", "--cpus", "2", "--partition", "short"};
  ASSERT_EQ(sweep("it's", {"--shard", "1/4"}).status, 0);
  const ProgramRun run = sweep("it's", slurm);
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string script = read_file(directory_ / "it's/sweep.sbatch"),
                    merge = read_file(directory_ / "it's/merge.sbatch");
  EXPECT_NE(run.out.find(script), std::string::npos) << run.out;
  EXPECT_NE(run.out.find(merge), std::string::npos) << run.out;
  for (const char* line : {"\n#SBATCH --array=0,2-3\n", "\n#SBATCH --time=2:00:00\n", "\n#SBATCH --cpus-per-task=2\n",
                           "\n#SBATCH --partition=short\n", "\n#SBATCH --requeue\n"}) {
    EXPECT_NE(script.find(line), std::string::npos) << line;
  }
  EXPECT_FALSE(fs::exists(directory_ / "it's/sweep_slurm.json"));
  // They do what Slurm would have them do: each task its shard, then the merge.
  for (const char* task : {"0", "2", "3"}) {
    const std::string text = "SLURM_ARRAY_TASK_ID=" + std::string(task) + "\n" + script;
    EXPECT_EQ(test::run_program("/bin/bash", {"-c", text}).status, 0);
  }
  EXPECT_EQ(test::run_program("/bin/bash", {"-c", merge}).status, 0);
  sweep("whole");
  for (const char* file : {"sweep.csv", "sweep.json"}) {
    EXPECT_EQ(read_file(directory_ / "it's" / file), read_file(directory_ / "whole" / file)) << file;
  }
}

TEST_F(SweepShards, AreNotSubmittedBesideAnotherSweep) {
  ASSERT_EQ(sweep("out", {"--shard", "1/4"}).status, 0);
  const ProgramRun run = sweep("out", {"--slurm", "4", "--dry-run", "--set", "seed=9"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("sweep_shard_1_of_4.csv: is of another sweep"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace hapbench::sweep_shards_test
