#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/slurm.hpp"

/// Sweeps on a real Slurm.
namespace hapbench::slurm_sweep_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;
using Words = std::vector<std::string>;

class SlurmSweep : public testing::Test {
 protected:
  void SetUp() override {
    const std::string missing = test::SlurmCluster::missing();
    if (!missing.empty()) GTEST_SKIP() << "no Slurm to test with, for want of " << missing;
    slurm_ = std::make_unique<test::SlurmCluster>();
  }

  /// Runs of some 20 ms.
  Words words(const std::string& out, const Words& more = {}) const {
    Words words = {"sweep",  "single_spring",
                   "--set",  "record.trajectory=false",
                   "--set",  "time.steps=100000",
                   "--vary", "rendering.stiffness_N_per_m=1e3:1e4:" + std::to_string(runs_) + ":log",
                   "--out",  (directory_ / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Json status() const { return hapbench({"sweep", "--status", (directory_ / "out").string(), "--json"}).json(); }
  std::string state(std::size_t shard) const { return status()["shards"][shard]["state"]; }

  /// Waits, however long it takes.
  template <class Condition>
  static void wait_until(Condition is_so) {
    while (!is_so()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  void wait_for(std::size_t shard, const std::string& wanted) const {
    wait_until([&] { return state(shard) == wanted; });
  }
  void wait_for_the_queue_to_empty() const {
    wait_until([&] { return (*slurm_)("squeue", {"--noheader"}).out.empty(); });
  }
  /// Submits three shards, kills shard 1 and has Slurm stop and requeue shard 0, as preemption does, once both have
  /// begun. Returns false when one of them ended before.
  bool submit_kill_and_requeue() const {
    const ProgramRun first = hapbench(words("out", {"--slurm", "3"}));
    EXPECT_EQ(first.status, 0) << first.err;
    EXPECT_NE(first.out.find("3 of 3 shards submitted as job "), std::string::npos) << first.out;
    wait_until([&] {
      const Json shards = status()["shards"];
      return shards[0]["runs_done"] >= 2 && shards[1]["runs_done"] >= 2;
    });
    const pid_t process = process_of("1/3");
    return process != 0 && process_of("0/3") != 0 && ::kill(process, SIGKILL) == 0 &&
           (*slurm_)("scontrol", {"requeue", array() + "_0"}).status == 0;
  }
  std::string array() const { return Json::parse(test::read_file(directory_ / "out/sweep_slurm.json"))["array"]; }

  std::string log_of_shard(const std::string& shard) const {
    return test::read_file(directory_ / "out" / ("slurm_shard_" + shard + ".log"));
  }

  /// The process that computes a shard into this test's directory; 0 for none.
  pid_t process_of(const std::string& shard) const {
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
      std::ifstream in(entry.path() / "cmdline", std::ios::binary);
      const std::string words((std::istreambuf_iterator<char>(in)), {});
      const bool is_it = words.starts_with(test::hapbench_program().string()) &&
                         words.find((directory_ / "out").string()) != std::string::npos &&
                         words.find('\0' + shard + '\0') != std::string::npos;
      if (is_it) return std::stoi(entry.path().filename());
    }
    return 0;
  }

  int runs_ = 120;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::SlurmCluster> slurm_;
};

TEST_F(SlurmSweep, WithAShardKilledAndOnePreemptedEndsWithTheBytesOfOneMachine) {
  // With more runs, a busy machine leaves time to interrupt them.
  for (; !submit_kill_and_requeue(); runs_ *= 4) {
    wait_for_the_queue_to_empty();
    fs::remove_all(directory_ / "out");
  }
  wait_for(1, "failed");
  wait_for(0, "waiting");
  const ProgramRun early = hapbench(words("out", {"--slurm", "3"}));
  EXPECT_EQ(early.status, 2);
  EXPECT_NE(early.err.find("is still in the queue; allowed: when it has ended"), std::string::npos) << early.err;

  // It would wait for two minutes. In the second in which it was stopped, Slurm would refuse to start it again ("Job
  // credential revoked").
  EXPECT_EQ((*slurm_)("scontrol", {"update", "JobId=" + array() + "_0", "StartTime=now+2seconds"}).status, 0);
  wait_for(0, "done");
  wait_for(2, "done");
  EXPECT_EQ(state(1), "failed");
  EXPECT_FALSE(fs::exists(directory_ / "out/sweep.csv")) << "merged without shard 1";
  wait_for_the_queue_to_empty();

  const ProgramRun second = hapbench(words("out", {"--slurm", "3"}));
  EXPECT_NE(second.out.find("1 of 3 shards submitted as job "), std::string::npos) << second.out << second.err;
  wait_until([&] { return status()["merged"] == true; });
  EXPECT_EQ(status()["done"], 3);
  ASSERT_EQ(hapbench(words("whole")).status, 0);
  for (const char* file : {"sweep.csv", "sweep.json"}) {
    EXPECT_EQ(test::read_file(directory_ / "out" / file), test::read_file(directory_ / "whole" / file)) << file;
  }
}

TEST_F(SlurmSweep, ThatSlurmRefusesSaysWhy) {
  const ProgramRun run = hapbench(words("out", {"--slurm", "3", "--partition", "none_such"}));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("invalid partition specified: none_such"), std::string::npos) << run.err;
  EXPECT_EQ(test::lines_of(run.err).size(), 1u) << run.err;
}

}  // namespace
}  // namespace hapbench::slurm_sweep_test
