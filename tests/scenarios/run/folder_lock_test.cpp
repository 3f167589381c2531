#include "scenarios/run/folder_lock.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "results/io/atomic_file.hpp"
#include "tests/results/files.hpp"

namespace hapbench::folder_lock_test {
namespace {

namespace fs = std::filesystem;

/// Returns the lock; empty if another process or thread holds it.
std::optional<FolderLock> try_lock(NewDirectories& directories, const fs::path& folder) {
  try {
    return FolderLock(directories, folder, "run", "run");
  } catch (const IoError&) {
    return std::nullopt;
  }
}

/// Returns the number of files below a folder. Folders are not counted: a process that ends may leave an empty parent
/// folder, because another process still had an empty folder in it.
std::ptrdiff_t files_in(const fs::path& folder) {
  return std::count_if(fs::recursive_directory_iterator(folder), fs::recursive_directory_iterator(),
                       [](const fs::directory_entry& entry) { return entry.is_regular_file(); });
}

/// Checks that one thread gets the lock when all threads try to lock a new folder at the same time. The winner keeps
/// its lock until all have tried.
TEST(FolderLock, IsHeldByOneOfManyThreads) {
  constexpr std::size_t kThreads = 4, kRounds = 1000;
  const test::TemporaryDirectory directory;
  std::vector<std::atomic<int>> winners(kRounds);
  std::barrier begin(kThreads), tried(kThreads);
  const auto work = [&] {
    for (std::size_t round = 0; round < kRounds; ++round) {
      begin.arrive_and_wait();
      NewDirectories directories;
      const auto lock = try_lock(directories, directory.path() / std::to_string(round) / "new");
      winners[round] += lock.has_value() ? 1 : 0;
      tried.arrive_and_wait();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kThreads; ++i) threads.emplace_back(work);
  }
  for (const auto& count : winners) ASSERT_EQ(count, 1);
  EXPECT_EQ(files_in(directory.path()), 0) << "lock files are left";
}

/// Checks locks without a barrier: threads lock, write and unlock, so that the lock file and the folder are repeatedly
/// created and removed by other threads.
TEST(FolderLock, ExcludesWhileItsFileIsRemoved) {
  const test::TemporaryDirectory directory;
  std::atomic<int> inside = 0, conflicts = 0, successes = 0;
  const auto work = [&] {
    for (int attempt = 0; attempt < 2000; ++attempt) {
      NewDirectories directories;
      const auto lock = try_lock(directories, directory.path() / "a" / "b");
      if (!lock) continue;
      conflicts += ++inside == 1 ? 0 : 1;
      std::this_thread::yield();
      --inside;
      ++successes;
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(work);
  }
  EXPECT_EQ(conflicts, 0);
  EXPECT_GT(successes, 0);
  EXPECT_EQ(files_in(directory.path()), 0);
}

/// Returns a child process that calls `work` and exits with its result.
template <class Work>
pid_t child(const Work& work) {
  const pid_t process = ::fork();
  if (process == 0) ::_exit(work());
  return process;
}

int status_of(pid_t process) {
  int status = 0;
  ::waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Checks that one process gets the lock when all processes try to lock a new folder. The processes start when the pipe
/// `begin` is closed. Each process ends when the pipe `end` is closed.
TEST(FolderLock, IsHeldByOneOfManyProcesses) {
  constexpr int kProcesses = 4, kRounds = 50;
  const test::TemporaryDirectory directory;
  for (int round = 0; round < kRounds; ++round) {
    int begin[2], tried[2], end[2];
    ASSERT_EQ(::pipe(begin) + ::pipe(tried) + ::pipe(end), 0);
    std::vector<pid_t> processes;
    for (int i = 0; i < kProcesses; ++i) {
      processes.push_back(child([&] {
        ::close(begin[1]);
        ::close(end[1]);
        char none = 0;
        (void)!::read(begin[0], &none, 1);
        NewDirectories directories;
        const auto lock = try_lock(directories, directory.path() / std::to_string(round) / "new");
        (void)!::write(tried[1], &none, 1);
        (void)!::read(end[0], &none, 1);
        return lock.has_value() ? 1 : 0;
      }));
    }
    ::close(begin[1]);
    char none = 0;
    for (int i = 0; i < kProcesses; ++i) ASSERT_EQ(::read(tried[0], &none, 1), 1);
    ::close(end[1]);
    int winners = 0;
    for (const pid_t process : processes) winners += status_of(process);
    ASSERT_EQ(winners, 1) << round;
    for (const int descriptor : {begin[0], tried[0], tried[1], end[0]}) ::close(descriptor);
  }
}

TEST(FolderLock, EndsWithAKilledProcess) {
  const test::TemporaryDirectory directory;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t process = child([&] {
    NewDirectories directories;
    const auto lock = try_lock(directories, directory.path());
    (void)!::write(ready[1], "", 1);
    for (;;) ::pause();
    return 0;
  });
  char none = 0;
  ASSERT_EQ(::read(ready[0], &none, 1), 1);
  NewDirectories directories;
  EXPECT_TRUE(FolderLock::is_held(directory.path(), "run"));
  EXPECT_FALSE(try_lock(directories, directory.path()));
  ::kill(process, SIGKILL);
  EXPECT_EQ(status_of(process), -1);
  EXPECT_FALSE(FolderLock::is_held(directory.path(), "run"));
  EXPECT_EQ(files_in(directory.path()), 1) << "the file of the killed process";
  EXPECT_TRUE(try_lock(directories, directory.path()));
  EXPECT_EQ(files_in(directory.path()), 0);
}

TEST(FolderLock, OfAnotherSetOrFolderDoesNotExclude) {
  const test::TemporaryDirectory directory;
  NewDirectories directories;
  const FolderLock run(directories, directory.path(), "run", "run");
  const FolderLock shard(directories, directory.path(), "sweep.0_of_2.csv", "sweep");
  const FolderLock other(directories, directory.path(), "sweep.1_of_2.csv", "sweep");
  const FolderLock inner(directories, directory.path() / "inner", "run", "run");
  EXPECT_TRUE(run.problem().empty());
  EXPECT_TRUE(FolderLock::is_held(directory.path(), "run"));
  EXPECT_FALSE(FolderLock::is_held(directory.path(), "compare"));
  EXPECT_THROW(require_unlocked_parents(directory.path() / "inner", "run", 1), IoError);
  EXPECT_NO_THROW(require_unlocked_parents(directory.path() / "inner", "compare", 3));
  try {
    const FolderLock second(directories, directory.path(), "run", "run");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(std::string(error.what()),
              "cannot write, because another run writes to " + directory.path().string() + ": Device or resource busy");
  }
}

}  // namespace
}  // namespace hapbench::folder_lock_test
