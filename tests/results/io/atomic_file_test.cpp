#include "results/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "tests/results/files.hpp"

namespace hapbench::atomic_file_test {
namespace {

namespace fs = std::filesystem;
using test::FileSizeLimit;
using test::read_file;
using test::TemporaryDirectory;
using test::write_plainly;
using Names = std::vector<std::string>;

TEST(AtomicFile, IsHiddenUntilCommitAndThenLikeAnyNewFile) {
  const TemporaryDirectory dir;
  AtomicFile file(dir / "a.csv");
  file.append("text");
  EXPECT_EQ(dir.entries(), Names{".a.csv.tmp"});
  EXPECT_THROW(AtomicFile(dir / "a.csv"), IoError) << "another writer has it";
  file.commit();
  write_plainly(dir / "plain", "");
  EXPECT_EQ(dir.entries(), (Names{"a.csv", "plain"}));
  EXPECT_EQ(read_file(dir / "a.csv"), "text");
  EXPECT_EQ(fs::status(dir / "a.csv").permissions(), fs::status(dir / "plain").permissions());
  write_file_atomically(dir / "a.csv", "second");
  EXPECT_EQ(read_file(dir / "a.csv"), "second");
  AtomicFile(dir / "a.csv").append("of a run that an exception ends");
  EXPECT_EQ(dir.entries(), (Names{"a.csv", "plain"}));
  EXPECT_EQ(read_file(dir / "a.csv"), "second");
}

TEST(AtomicFile, WhereNoFileCanBeThrowsAndLeavesNoTemporary) {
  const TemporaryDirectory dir;
  fs::create_directory(dir / "a.csv");
  EXPECT_THROW(AtomicFile(dir / "a.csv"), IoError);
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
  try {
    AtomicFile file(dir / "missing/a.csv");
    FAIL() << "opened a file in a missing directory";
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), "cannot create " + (dir / "missing/a.csv").string() + ": No such file or directory");
  }
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no device to refuse here";
  EXPECT_THROW(AtomicFile("/dev/full"), IoError);
}

TEST(AtomicFile, ThatRunsOutOfSpaceThrowsAtCommitAndLeavesTheOldTarget) {
  for (const std::size_t bytes : {1'000'000u, 20u}) {  // many times the buffer, and what it still holds at the end
    const TemporaryDirectory dir;
    write_plainly(dir / "a.csv", "old");
    AtomicFile file(dir / "a.csv");
    {
      const FileSizeLimit limit(bytes / 2);
      file.append(std::string(bytes, 'x'));
      EXPECT_THROW(file.commit(), IoError);
    }
    EXPECT_EQ(dir.entries(), Names{"a.csv"});
    EXPECT_EQ(read_file(dir / "a.csv"), "old");
  }
}

/// A process that is killed while it writes `target`. What it leaves is longer than what tests write.
void kill_a_writer_of(const fs::path& target) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    AtomicFile file(target);
    file.append(std::string(100'000, 'x'));
    ::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(FileSet, ReplacesFilesTogetherAndRemovesWhatKilledProcessesLeft) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a", "old a");
  write_plainly(dir / "gone", "old");
  for (const char* name : {"a", "gone", "never there"}) kill_a_writer_of(dir / name);
  FileSet files;
  files.remove(dir / "gone");
  files.remove(dir / "never there");
  files.write(dir / "a", "new a");
  files.write(dir / "b", "new b");
  EXPECT_EQ(read_file(dir / "a"), "old a");
  files.commit();
  EXPECT_EQ(dir.entries(), (Names{"a", "b"}));
  EXPECT_EQ(read_file(dir / "a"), "new a");
}

TEST(FileSet, LeavesEverythingAsItWasOnAFullDisk) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a", "old a");
  write_plainly(dir / "gone", "still here");
  FileSet files;
  files.remove(dir / "gone");
  files.write(dir / "a", "new a");
  files.write(dir / "b", "larger than the disk");
  {
    const FileSizeLimit limit(10);
    EXPECT_THROW(files.commit(), IoError);
  }
  EXPECT_EQ(read_file(dir / "a"), "old a");
  EXPECT_EQ(read_file(dir / "gone"), "still here");
  EXPECT_FALSE(fs::exists(dir / "b"));
}

}  // namespace
}  // namespace hapbench::atomic_file_test
