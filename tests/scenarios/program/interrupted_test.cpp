#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

#include "scenarios/batch/table_file.hpp"
#include "scenarios/run/folder_lock.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// Tests commands that are killed or stopped while they compute, and sweeps that are continued.
namespace hapbench::interrupted_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using test::hapbench;
using test::ProgramRun;
using test::RunningProgram;

/// Fixture with a run that takes minutes and is killed when it has begun to write.
class KilledRun : public testing::Test {
 protected:
  void kill_a_run() const {
    const std::uintmax_t before = bytes_written();
    test::RunningProgram run(test::hapbench_program(),
                             {"run", "single_spring", "--out", out_.string(), "--set", "time.steps=20000000"});
    EXPECT_TRUE(run.runs_until([&] { return bytes_written() >= before + 100'000; }));
    EXPECT_TRUE(run.kill()) << "it had ended before it was killed";
  }
  std::uintmax_t bytes_written() const {
    std::uintmax_t bytes = 0;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(out_, ignored)) {
      const auto size = entry.file_size(ignored);
      if (!ignored) bytes += size;
    }
    return bytes;
  }

  test::TemporaryDirectory directory_;
  fs::path out_ = directory_ / "out";
};

TEST_F(KilledRun, LeavesNoFileUnderAFinalNameAndIsCleanedUpByTheNext) {
  const Words words = {"run", "single_spring", "--out", out_.string()};
  test::hapbench(words);
  const auto before = test::files_below(out_);
  std::size_t temporaries = 0;
  kill_a_run();
  fs::remove(out_ / ".run.lock");  // the next command removes the lock of the killed command
  auto after = test::files_below(out_);
  std::erase_if(after, [&](const auto& file) {
    const bool is_temporary = fs::path(file.first).filename().string().starts_with('.') && file.first.ends_with(".tmp");
    temporaries += is_temporary;
    return is_temporary;
  });
  EXPECT_GT(temporaries, 0u);
  EXPECT_EQ(after, before) << "the results of an earlier run are complete";
  EXPECT_EQ(test::hapbench(words).status, 0);
  EXPECT_EQ(test::files_below(out_), before);
}

TEST(FailedWrite, LeavesTheResultsOfAnEarlierRun) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string();
  EXPECT_EQ(hapbench({"run", "poke_plane", "--out", out}).status, 0);
  const auto before = test::files_below(out);
  // trajectory.csv is larger than the file limit, so that writing fails as on a full disk.
  const ProgramRun again =
      hapbench({"run", "poke_plane", "--set", "rendering.algorithm=mean", "--out", out}, {.file_limit = 50'000});
  EXPECT_EQ(again.status, 1) << again.err;
  EXPECT_EQ(test::files_below(out), before);
}

TEST(FailedWrite, OfStandardOutputIsAFailure) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const ProgramRun all =
      test::run_program("/bin/sh", {"-c", "\"$0\" describe >/dev/full", test::hapbench_program().string()});
  EXPECT_EQ(all.status, 1);
  EXPECT_NE(all.err.find("cannot write standard output"), std::string::npos) << all.err;
}

TEST(FailedWrite, OfAFolderThatAnotherRunWritesTo) {
  const test::TemporaryDirectory directory;
  fs::create_directory(directory / "out");
  NewDirectories directories;
  auto lock = std::make_optional<FolderLock>(directories, directory / "out", "run", "run");
  const ProgramRun run = hapbench({"run", "poke_plane", "--out", (directory / "out").string()});
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("another run writes to"), std::string::npos) << run.err;
  lock.reset();
  EXPECT_TRUE(fs::is_empty(directory / "out"));
}

/// Fixture with a program that waits for input from a pipe into which nobody writes. While it waits, it does not notice
/// a signal to stop.
class Stopped : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path pipe = directory_ / "scenario.json";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    reader_.emplace(test::hapbench_program(), Words{"validate", pipe.string()});
    // The writing end cannot be opened before the program has opened the reading end.
    ASSERT_TRUE(reader_->runs_until([&] { return (writer_ = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK)) >= 0; }));
  }
  void TearDown() override { ::close(writer_); }
  /// Returns standard error without progress lines. The program may print a progress line at any time until it exits.
  std::string message() {
    std::string text;
    for (const std::string& line : test::lines_of(reader_->err()))
      if (line.find("scenario.json ... ") == std::string::npos) text += line + "\n";
    return text;
  }

  test::TemporaryDirectory directory_;
  std::optional<RunningProgram> reader_;
  int writer_ = -1;
};

constexpr const char* kEndedAmidWork = "hapbench: ended amid work that did not notice the signal for two seconds\n";

TEST_F(Stopped, WithinTwoSecondsWhereverItIs) {
  const auto sent = std::chrono::steady_clock::now();
  EXPECT_EQ(reader_->end_by(SIGTERM), -SIGTERM);
  EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(5)) << "the machine may be busy";
  EXPECT_EQ(message(), kEndedAmidWork);
}

TEST_F(Stopped, NotAtOnceByASignalThatIsDeliveredTwice) {
  const auto first = std::chrono::steady_clock::now();
  reader_->send(SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // two pending signals of the same kind would be merged
  reader_->send(SIGTERM);
  if (std::chrono::steady_clock::now() - first > std::chrono::milliseconds(100)) GTEST_SKIP() << "the machine is busy";
  EXPECT_EQ(reader_->wait(), -SIGTERM);
  EXPECT_EQ(message(), kEndedAmidWork);
}

TEST_F(Stopped, AtOnceByASecondSignal) {
  reader_->send(SIGTERM);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(reader_->end_by(SIGINT), -SIGINT);
  EXPECT_EQ(message(), "");
}

/// Fixture of commands that Ctrl-C ends while they compute.
class InterruptedCommand : public testing::Test {
 protected:
  /// Starts a command that takes minutes. Sends the signal when the command has created its directory and has had time
  /// to begin. Returns the exit status.
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

TEST_F(InterruptedCommand, EndsWith130AndLeavesWhatWasThereBefore) {
  for (const Words& words :
       {Words{"compare", "single_spring", "--algorithms", "mean,proxy", "--set", "time.steps=20000000"},
        Words{"limit", "wall_on_handle", "--over", "rendering.damping_N_s_per_m=1:100:10000", "--quiet"},
        Words{"stress", "--count", "1000000000", "--quiet"}}) {
    EXPECT_EQ(status_after(SIGINT, words), 130) << words[0];
    EXPECT_EQ(directory_.entries(), Words{}) << words[0];
  }
  ASSERT_EQ(test::hapbench({"run", "single_spring", "--out", out_.string()}).status, 0);
  const auto before = test::files_below(out_);
  EXPECT_EQ(status_after(SIGTERM, {"run", "single_spring", "--set", "time.steps=20000000", "--latency"}), 143);
  EXPECT_EQ(test::files_below(out_), before);
}

/// Fixture of sweeps that are killed and continued; batch/sweep_test.cpp tests all other interruptions.
class KilledSweep : public testing::Test {
 protected:
  /// Returns the arguments of a sweep of at least 180 runs of some milliseconds.
  Words words(const std::string& out, const Words& more = {}, const char* jobs = "2") const {
    Words words = {"sweep",  "single_spring",
                   "--set",  "record.trajectory=false",
                   "--vary", "time.steps=20000:20002:3",
                   "--vary", "rendering.stiffness_N_per_m=1e3:1e4:" + std::to_string(runs_ / 3) + ":log",
                   "--jobs", jobs,
                   "--out",  (directory_ / out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// Returns the number of rows of the unfinished table.
  std::size_t rows() const { return TableFile::rows_in_progress(directory_ / "out/sweep.csv"); }
  /// Starts a sweep and kills it after ten rows. Returns false if the sweep ended first, because a busy machine delayed
  /// the test.
  bool is_killed() const {
    RunningProgram sweep(test::hapbench_program(), words("out"));
    return sweep.runs_until([&] { return rows() >= 10; }) && sweep.kill();
  }

  std::size_t runs_ = 180;
  test::TemporaryDirectory directory_;
};

TEST_F(KilledSweep, GoesOnToTheSameBytes) {
  for (; !is_killed(); runs_ *= 4) {
    ASSERT_LT(runs_, 10'000'000) << "the program does not run";
    fs::remove_all(directory_ / "out");
  }
  EXPECT_FALSE(fs::exists(directory_ / "out/sweep.csv"));
  const std::size_t done = rows();
  // The next command removes the lock of the killed command.
  fs::remove(directory_ / "out/.sweep.csv.lock");
  const auto left = test::files_below(directory_ / "out");
  const ProgramRun refused = hapbench(words("out"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find(fmt::format("sweep.csv.part: holds {} finished runs of this sweep", done)),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(hapbench(words("out", {"--resume", "--set", "seed=7"})).status, 2) << "another sweep";
  EXPECT_EQ(test::files_below(directory_ / "out"), left);
  const ProgramRun end = hapbench(words("out", {"--resume"}, "5"));
  EXPECT_EQ(end.status, 0) << end.err;
  EXPECT_NE(end.out.find("\n" + std::to_string(done) + " of the runs were taken from the interrupted sweep\n"),
            std::string::npos)
      << end.out;
  ASSERT_EQ(hapbench(words("whole")).status, 0);
  test::expect_same_files(directory_ / "whole", directory_ / "out");
}

}  // namespace
}  // namespace hapbench::interrupted_test
