#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// Commands other than sweep that Ctrl-C ends while they compute.
namespace hapbench::interrupted_commands_test {
namespace {

namespace fs = std::filesystem;
using test::RunningProgram;
using Words = std::vector<std::string>;

class InterruptedCommand : public testing::Test {
 protected:
  /// Starts a command that takes minutes and sends it the signal once it has made its directory and had time to begin.
  int status_after(int signal, Words words) const {
    words.insert(words.end(), {"--out", out_.string()});
    RunningProgram program(test::hapbench_program(), words);
    EXPECT_TRUE(program.runs_until([&] { return fs::exists(out_); })) << words.front();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_TRUE(program.is_running()) << words.front();
    return program.end_by(signal);
  }

  test::TemporaryDirectory directory_;
  fs::path out_ = directory_ / "out" / "below";
};

const Words kCommands[] = {
    {"run", "single_spring", "--set", "time.steps=20000000"},
    {"run", "single_spring", "--set", "time.steps=20000000", "--latency"},
    {"compare", "single_spring", "--algorithms", "mean,proxy", "--set", "time.steps=20000000"},
    {"stability", "--map", "all", "--size", "101", "--quiet"},
    {"stability", "--stress", "--count", "1000000000", "--quiet"},
    {"stability", "drill_in_hole", "--search", "--evaluations", "1000000", "--quiet"},
    {"limit", "single_spring", "--vary", "rendering.stiffness_N_per_m", "--set", "time.steps=500000000", "--set",
     "record.trajectory=false", "--set", "rendering.damping_ratio=0", "--quiet"},
    {"precision", "time_step", "--scenario", "single_spring", "--set", "time.steps=10000000", "--quiet"},
};

TEST_F(InterruptedCommand, EndsWith130AndLeavesNothing) {
  for (const Words& words : kCommands) {
    EXPECT_EQ(status_after(SIGINT, words), 130) << words[0] << " " << words[1];
    EXPECT_EQ(directory_.entries(), Words{}) << words[0] << " " << words[1];
  }
}

TEST_F(InterruptedCommand, EndsWith143BySigterm) {
  EXPECT_EQ(status_after(SIGTERM, kCommands[0]), 143);
  EXPECT_EQ(directory_.entries(), Words{});
}

TEST_F(InterruptedCommand, LeavesWhatWasThereBefore) {
  ASSERT_EQ(test::hapbench({"run", "single_spring", "--out", out_.string()}).status, 0);
  const auto before = test::files_below(out_);
  EXPECT_EQ(status_after(SIGINT, kCommands[0]), 130);
  EXPECT_EQ(test::files_below(out_), before);
}

TEST(LargeOutput, IsAnnounced) {
  const test::TemporaryDirectory directory;
  const auto err_of = [&](const char* steps) {
    return test::hapbench({"run", "single_spring", "--quiet", "--set", std::string("time.steps=") + steps, "--set",
                           "bounds.position_m=1e-9", "--set", "expect.outcome=diverges", "--out",
                           (directory / "out").string()})
        .err;
  };
  EXPECT_EQ(err_of("1000"), "");
  const std::string err = err_of("1000000");
  EXPECT_NE(err.find("about 372 MB will be written"), std::string::npos) << err;
}

}  // namespace
}  // namespace hapbench::interrupted_commands_test
