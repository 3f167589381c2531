#include "results/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <string>

#include "tests/results/files.hpp"

namespace hapbench::atomic_file_test {
namespace {

using test::FileSizeLimit;
using test::read_file;
using test::TemporaryDirectory;
using test::write_plainly;
using Names = std::vector<std::string>;

TEST(AtomicFile, IsHiddenUnderATemporaryNameUntilCommit) {
  const TemporaryDirectory dir;
  AtomicFile file(dir / "a.csv");
  file.append("text");
  EXPECT_EQ(dir.entries(), Names{".a.csv.tmp"});
  file.commit();
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
  EXPECT_EQ(read_file(dir / "a.csv"), "text");
}

TEST(AtomicFile, IsRefusedWhileAnotherWriterHasIt) {
  const TemporaryDirectory dir;
  {
    AtomicFile file(dir / "a.csv");
    file.append("first");
    EXPECT_THROW(AtomicFile(dir / "a.csv"), IoError);
    file.commit();
  }
  write_file_atomically(dir / "a.csv", "second");
  EXPECT_EQ(read_file(dir / "a.csv"), "second");
}

TEST(AtomicFile, RemovesItsTemporaryWhenAnExceptionEndsTheRun) {
  const TemporaryDirectory dir;
  try {
    AtomicFile file(dir / "a.csv");
    file.append("half a line");
    throw std::runtime_error("the run failed");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(dir.entries(), Names{});
}

TEST(AtomicFile, KeepsEveryByteOfContentsLargerThanItsBuffer) {
  const TemporaryDirectory dir;
  std::string expected;
  AtomicFile file(dir / "a.csv");
  // Pieces of 1 … 4001 bytes, so that they end everywhere in the buffer, and one larger than any buffer.
  for (std::size_t n = 1; n < 4002; n += 100) {
    const std::string piece(n, static_cast<char>('a' + n % 26));
    file.append(piece);
    expected += piece;
  }
  const std::string large(1 << 20, '#');
  file.append(large);
  file.commit();
  EXPECT_TRUE(read_file(dir / "a.csv") == expected + large);
}

TEST(AtomicFile, InAMissingDirectoryThrowsNamingTheTarget) {
  const TemporaryDirectory dir;
  const auto target = dir.path() / "missing" / "a.csv";
  try {
    AtomicFile file(target);
    FAIL() << "opened " << target;
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), target);
    EXPECT_EQ(error.reason(), std::errc::no_such_file_or_directory);
    EXPECT_NE(std::string(error.what()).find(target.string()), std::string::npos) << error.what();
  }
}

TEST(AtomicFile, OverWhatIsNoFileThrowsAndLeavesNoTemporary) {
  const TemporaryDirectory dir;
  std::filesystem::create_directory(dir / "a.csv");
  EXPECT_THROW(AtomicFile(dir / "a.csv"), IoError);
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no device to refuse here";
  EXPECT_THROW(AtomicFile("/dev/full"), IoError);
}

TEST(AtomicFile, ThatRunsOutOfSpaceThrowsAtCommitAndLeavesTheOldTarget) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a.csv", "old");
  AtomicFile file(dir / "a.csv");
  bool good = true;
  std::error_code reason;
  {
    const FileSizeLimit limit(100'000);
    file.append(std::string(1'000'000, 'x'));
    good = file.good();
    try {
      file.commit();
    } catch (const IoError& error) {
      reason = error.reason();
    }
  }
  EXPECT_FALSE(good);
  EXPECT_EQ(reason, std::errc::file_too_large);
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
  EXPECT_EQ(read_file(dir / "a.csv"), "old");
}

TEST(AtomicFile, ThatRunsOutOfSpaceWithItsLastBytesThrowsAtCommit) {
  const TemporaryDirectory dir;
  AtomicFile file(dir / "a.csv");
  file.append("fits the buffer, not the disk");
  EXPECT_TRUE(file.good());
  std::error_code reason;
  {
    const FileSizeLimit limit(10);
    try {
      file.commit();
    } catch (const IoError& error) {
      reason = error.reason();
    }
  }
  EXPECT_EQ(reason, std::errc::file_too_large);
  EXPECT_EQ(dir.entries(), Names{});
}

TEST(AtomicFile, HasThePermissionsOfAnyNewFile) {
  const TemporaryDirectory dir;
  write_plainly(dir / "plain", "");
  write_file_atomically(dir / "a.csv", "");
  EXPECT_EQ(std::filesystem::status(dir / "a.csv").permissions(), std::filesystem::status(dir / "plain").permissions());
}

/// A process that is killed while it writes `target`. What it leaves is longer than what tests write.
void kill_a_writer_of(const std::filesystem::path& target) {
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

TEST(FileSet, ReplacesFilesTogether) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a", "old a");
  write_plainly(dir / "gone", "old");
  kill_a_writer_of(dir / "a");
  FileSet files;
  files.remove(dir / "gone");
  files.remove(dir / "never there");
  files.write(dir / "a", "new a");
  files.write(dir / "b", "new b");
  EXPECT_EQ(test::read_file(dir / "a"), "old a");
  files.commit();
  EXPECT_EQ(dir.entries(), (Names{"a", "b"}));
  EXPECT_EQ(test::read_file(dir / "a"), "new a");
}

TEST(FileSet, LeavesNothingWhenItIsNotCommitted) {
  const TemporaryDirectory dir;
  FileSet().write(dir / "a", "never");
  EXPECT_EQ(dir.entries(), Names{});
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
  EXPECT_FALSE(std::filesystem::exists(dir / "b"));
}

TEST(FileSet, RemovesWhatAKilledProcessLeftOfFilesThatGo) {
  const TemporaryDirectory dir;
  kill_a_writer_of(dir / "gone");
  ASSERT_EQ(dir.entries().size(), 1u);
  FileSet files;
  files.remove(dir / "gone");
  files.commit();
  EXPECT_EQ(dir.entries(), Names{});
}

namespace fs = std::filesystem;

TEST(NewDirectories, RemovesWhatItMadeAndNobodyUsed) {
  const test::TemporaryDirectory directory;
  fs::create_directory(directory / "mine");
  {
    NewDirectories made;
    std::error_code error;
    for (const char* name : {"a/b/c", "a/used", "mine", "mine/below"}) {
      made.create(directory / name, error);
      EXPECT_FALSE(error) << name;
      EXPECT_TRUE(fs::is_directory(directory / name)) << name;
    }
    test::write_plainly(directory / "a/used/file", "x");
  }
  EXPECT_TRUE(fs::exists(directory / "a/used/file"));
  EXPECT_FALSE(fs::exists(directory / "a/b"));
  EXPECT_TRUE(fs::exists(directory / "mine")) << "empty, but not its own";
  EXPECT_FALSE(fs::exists(directory / "mine/below"));
}

TEST(NewDirectories, SaysWhenItCannot) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "file", "mine");
  {
    NewDirectories made;
    std::error_code error;
    made.create(directory / "file/below", error);
    EXPECT_TRUE(error);
  }
  EXPECT_EQ(test::read_file(directory / "file"), "mine");
}

}  // namespace
}  // namespace hapbench::atomic_file_test
