#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/environment_variable.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/scale.hpp"

/// The cache of built shells as the program's user and its other processes see it.
namespace hapbench {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::ProgramRun;

class CachedShell : public testing::Test {
 protected:
  CachedShell() {
    const Json json = Json::parse(R"({"name": "drilled", "time": {"step_s": 0.0005, "steps": 20},
      "environment": {"type": "block_with_hole", "size_m": [0.006, 0.006, 0.004], "hole_depth_m": 0.002},
      "initial": {"position_m": [0.0006, 0, -0.001]}, "rendering": {"reduction": {}},
      "record": {"contacts": true, "timing": true}})");
    test::write_plainly(scenario_, json.dump());
    EXPECT_EQ(run_into("reference", {"--no-cache"}).status, 0);
  }

  std::vector<std::string> arguments(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"run", scenario_.string(), "--out", (directory_ / out).string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProgramRun run_into(const std::string& out, const std::vector<std::string>& more = {},
                      const test::ProgramOptions& options = {}) const {
    return hapbench(arguments(out, more), options);
  }
  bool came_from_cache(const std::string& out) const {
    return Json::parse(test::read_file(directory_.path() / out / "timing.json"))["shell_from_cache"];
  }
  /// All but the times is what a run without the cache wrote.
  void expect_reference_results(const std::string& out) const {
    test::expect_same_files(directory_ / out, directory_ / "reference", {"timing.json"});
  }
  /// The one file the cache holds, hidden ones included.
  std::string the_shell() const {
    const auto names = test::names_below(cache_);
    EXPECT_EQ(names.size(), 1u);
    return names.empty() ? "" : test::read_file(cache_ / names[0]);
  }

  test::TemporaryDirectory directory_;
  fs::path scenario_ = directory_ / "drilled.json", cache_ = directory_ / "cache";
  test::EnvironmentVariable variable_{"HAPBENCH_CACHE_DIR", cache_.string()};
};

TEST_F(CachedShell, GivesTheSameFilesAsABuiltOne) {
  EXPECT_FALSE(fs::exists(cache_));
  for (const char* out : {"first", "second"}) {
    const ProgramRun run = run_into(out);
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_EQ(came_from_cache(out), out == std::string("second"));
    expect_reference_results(out);
  }
}

TEST_F(CachedShell, ServesCompareAndShellToo) {
  run_into("first");
  const std::string shell = the_shell();
  const auto shell_into = [this](const char* name, std::vector<std::string> more) {
    more.insert(more.begin(), {"shell", scenario_.string(), "--out", (directory_ / name).string()});
    EXPECT_EQ(hapbench(more).status, 0);
    return test::read_file(directory_ / name);
  };
  EXPECT_EQ(shell_into("cached.csv", {}), shell_into("built.csv", {"--no-cache"}));
  EXPECT_EQ(hapbench({"compare", scenario_.string(), "--algorithms", "mean,summation", "--out",
                      (directory_ / "compared").string()})
                .status,
            0);
  EXPECT_TRUE(came_from_cache("compared/mean") && came_from_cache("compared/summation"));
  EXPECT_EQ(the_shell(), shell);
}

TEST_F(CachedShell, IsReplacedWhenItsFileIsDamaged) {
  run_into("first");
  const std::string good = the_shell(), name = test::names_below(cache_)[0];
  std::string flipped = good;
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 4);
  for (const std::string& damaged : {std::string(), good.substr(0, good.size() / 2), flipped, good + good}) {
    test::write_plainly(cache_ / name, damaged);
    EXPECT_EQ(run_into("again").err, "");
    EXPECT_FALSE(came_from_cache("again"));
    expect_reference_results("again");
    EXPECT_TRUE(the_shell() == good);
  }
}

TEST_F(CachedShell, IsNotThatOfAnotherBuild) {
  run_into("first");
  ASSERT_EQ(test::run_program(test::hapbench_scalar_program(), arguments("scalar")).status, 0);
  EXPECT_FALSE(came_from_cache("scalar"));
  expect_reference_results("scalar");
  EXPECT_EQ(test::names_below(cache_).size(), 2u);
}

TEST_F(CachedShell, IsNotUsedAndNotMadeWithNoCache) {
  run_into("first", {"--no-cache"});
  EXPECT_FALSE(fs::exists(cache_));
  run_into("second");
  run_into("third", {"--no-cache"});
  EXPECT_FALSE(came_from_cache("third"));
}

TEST_F(CachedShell, IsNotMadeWhenTheVariableIsEmpty) {
  const test::EnvironmentVariable off("HAPBENCH_CACHE_DIR", "");
  const test::EnvironmentVariable home("HOME", (directory_ / "home").string());
  for (const char* out : {"first", "second"}) {
    EXPECT_EQ(run_into(out).err, "");
    EXPECT_FALSE(came_from_cache(out));
    expect_reference_results(out);
  }
  EXPECT_FALSE(fs::exists(cache_));
  EXPECT_FALSE(fs::exists(directory_ / "home"));
}

TEST_F(CachedShell, MayBeInADirectoryThatCannotBeWrittenOrRead) {
  run_into("first");
  const std::string good = the_shell();
  test::ProgramOptions unprivileged;
  unprivileged.as_root_may = false;
  if (hapbench({"list"}, unprivileged).status == 126) GTEST_SKIP() << "root's privileges cannot be dropped here";
  // Readable: used. Not searchable: built. Both without a word.
  for (const auto& [mode, used] : {std::pair(0555, true), std::pair(0000, false)}) {
    fs::permissions(cache_, static_cast<fs::perms>(mode));
    const ProgramRun run = run_into("again", {}, unprivileged);
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_EQ(came_from_cache("again"), used) << mode;
    expect_reference_results("again");
    fs::permissions(cache_, fs::perms::owner_all);
  }
  EXPECT_TRUE(the_shell() == good);
}

TEST_F(CachedShell, MayBeAFileThatCannotBeRead) {
  run_into("first");
  const std::string good = the_shell(), name = test::names_below(cache_)[0];
  fs::permissions(cache_ / name, fs::perms::none);
  test::ProgramOptions unprivileged;
  unprivileged.as_root_may = false;
  if (hapbench({"list"}, unprivileged).status == 126) GTEST_SKIP() << "root's privileges cannot be dropped here";
  EXPECT_EQ(run_into("again", {}, unprivileged).err, "");
  EXPECT_FALSE(came_from_cache("again"));
  expect_reference_results("again");
  // Replaced: the directory is writable.
  EXPECT_TRUE(run_into("third", {}, unprivileged).status == 0 && came_from_cache("third"));
  EXPECT_TRUE(the_shell() == good);
}

TEST_F(CachedShell, IsLeftOutWhereFilesMayNotBeSoLarge) {
  test::ProgramOptions limited;
  limited.file_limit = 250'000;  // more than the results take, less than the shell
  const ProgramRun run = run_into("limited", {}, limited);
  EXPECT_EQ(run.signal, 0);
  EXPECT_EQ(run.status, 0) << run.err;
  expect_reference_results("limited");
  EXPECT_TRUE(test::names_below(cache_).empty());
}

TEST_F(CachedShell, MayBeMadeByEightProcessesAtOnce) {
  constexpr int kProcesses = 8;
  std::vector<std::unique_ptr<test::RunningProgram>> running;
  for (int i = 0; i < kProcesses; ++i) {
    running.push_back(
        std::make_unique<test::RunningProgram>(test::hapbench_program(), arguments("out" + std::to_string(i))));
  }
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(100);
  for (const auto& process : running) {
    while (process->is_running() && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  for (int i = 0; i < kProcesses; ++i) expect_reference_results("out" + std::to_string(i));
  EXPECT_FALSE(the_shell().empty());  // and no temporary
  run_into("after");
  EXPECT_TRUE(came_from_cache("after"));
  expect_reference_results("after");
}

TEST_F(CachedShell, SurvivesItsWriterBeingKilled) {
  // Each a little later after it began to write, so that some die half-way and some when all is done.
  for (std::size_t i = 0; i < test::cases(60); ++i) {
    fs::remove_all(cache_);
    test::RunningProgram run(test::hapbench_program(), arguments("killed"));
    while (run.is_running() && !fs::exists(cache_)) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(3 * i));
    run.kill();
    EXPECT_EQ(run_into("after").status, 0);
    expect_reference_results("after");
    const std::string shell = the_shell();  // and no temporary
    run_into("again");
    EXPECT_TRUE(came_from_cache("again"));
    EXPECT_TRUE(the_shell() == shell);
  }
}

TEST_F(CachedShell, IsDescribed) {
  run_into("first");
  const ProgramRun text = hapbench({"describe", "cache"});
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find(cache_.string()), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("1 shells"), std::string::npos) << text.out;
  EXPECT_EQ(hapbench({"describe", "cache", "--json"}).json(),
            (Json{{"kind", "cache"}, {"directory", cache_.string()}, {"shells", 1}, {"bytes", the_shell().size()}}));
  const test::EnvironmentVariable off("HAPBENCH_CACHE_DIR", "");
  EXPECT_NE(hapbench({"describe", "cache"}).out.find("none: nothing is kept"), std::string::npos);
}

}  // namespace
}  // namespace hapbench
