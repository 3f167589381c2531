#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::killed_run_test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

/// A run of minutes, killed once it has begun to write.
class KilledRun : public testing::Test {
 protected:
  /// Names of what it left.
  Names kill_a_run() const {
    test::RunningProgram run(test::hapbench_program(),
                             {"run", "single_spring", "--out", out_.string(), "--set", "time.steps=20000000"});
    EXPECT_TRUE(run.runs_until([&] { return bytes_written() >= 100'000; }));
    EXPECT_TRUE(run.kill()) << "it had ended before it was killed";
    return test::names_below(out_);
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

TEST_F(KilledRun, LeavesNoFileUnderAFinalName) {
  const Names left = kill_a_run();
  EXPECT_FALSE(left.empty());
  for (const std::string& name : left) {
    EXPECT_TRUE(name.starts_with('.') && name.ends_with(".tmp")) << name;
  }
}

TEST_F(KilledRun, IsCleanedUpByTheNext) {
  kill_a_run();
  const test::ProgramRun run = test::hapbench({"run", "single_spring", "--out", out_.string()});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(test::names_below(out_),
            (Names{"columns.json", "scenario.effective.json", "summary.json", "trajectory.csv"}));
  // Nothing of the killed run is in the new one.
  test::hapbench({"run", "single_spring", "--out", (directory_ / "fresh").string()});
  test::expect_same_files(out_, directory_ / "fresh");
}

TEST_F(KilledRun, LeavesTheResultsOfAnEarlierRunComplete) {
  test::hapbench({"run", "single_spring", "--out", out_.string()});
  const auto before = test::files_below(out_);
  kill_a_run();
  auto after = test::files_below(out_);
  std::erase_if(after, [](const auto& file) { return file.first.ends_with(".tmp"); });
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace hapbench::killed_run_test
