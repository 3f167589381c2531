#include "results/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

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
  ASSERT_EQ(dir.entries().size(), 1u);
  const std::string temporary = dir.entries()[0];
  EXPECT_TRUE(temporary.starts_with(".a.csv.") && temporary.ends_with(".tmp")) << temporary;
  file.commit();
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
  EXPECT_EQ(read_file(dir / "a.csv"), "text");
}

TEST(AtomicFile, LeavesAnExistingTargetAloneUntilCommit) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a.csv", "old and longer");
  AtomicFile file(dir / "a.csv");
  file.append("new");
  EXPECT_EQ(read_file(dir / "a.csv"), "old and longer");
  file.commit();
  EXPECT_EQ(read_file(dir / "a.csv"), "new");
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

TEST(AtomicFile, IsCompleteBeforeItHasItsName) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a.csv", "old");
  AtomicFile file(dir / "a.csv");
  file.append("new");
  file.complete();
  EXPECT_EQ(read_file(dir / "a.csv"), "old");
  file.commit();
  EXPECT_EQ(read_file(dir / "a.csv"), "new");
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

TEST(AtomicFile, OfSeveralWritersTheLastToCommitWins) {
  const TemporaryDirectory dir;
  AtomicFile first(dir / "a.csv"), second(dir / "a.csv"), third(dir / "a.csv");
  first.append("first");
  second.append("the second");
  third.append("given up");
  second.commit();
  EXPECT_EQ(read_file(dir / "a.csv"), "the second");
  first.commit();
  EXPECT_EQ(read_file(dir / "a.csv"), "first");
}

TEST(AtomicFile, IsNotDisturbedByCleaningUpAtTheSameTime) {
  const TemporaryDirectory dir;
  std::atomic<bool> done = false;
  std::thread cleaner([&] {
    while (!done) remove_stale_temporaries(dir.path());
  });
  for (int i = 0; i < 500; ++i) EXPECT_NO_THROW(write_file_atomically(dir / "a.csv", std::to_string(i)));
  done = true;
  cleaner.join();
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
  EXPECT_EQ(read_file(dir / "a.csv"), "499");
}

TEST(AtomicFile, HasThePermissionsOfAnyNewFile) {
  const TemporaryDirectory dir;
  write_plainly(dir / "plain", "");
  write_file_atomically(dir / "a.csv", "");
  EXPECT_EQ(std::filesystem::status(dir / "a.csv").permissions(), std::filesystem::status(dir / "plain").permissions());
}

TEST(WriteFileAtomically, WritesTheContentsAndNothingElse) {
  const TemporaryDirectory dir;
  write_file_atomically(dir / "summary.json", "{}\n");
  EXPECT_EQ(dir.entries(), Names{"summary.json"});
  EXPECT_EQ(read_file(dir / "summary.json"), "{}\n");
}

/// A process that is killed while it writes `target`.
void kill_a_writer_of(const std::filesystem::path& target) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    AtomicFile file(target);
    file.append("half a file");
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

TEST(FileSet, LeavesEverythingAsItWasWhenAFileCannotComeIn) {
  const TemporaryDirectory dir;
  write_plainly(dir / "a", "old a");
  write_plainly(dir / "gone", "still here");
  std::filesystem::create_directory(dir / "later");
  FileSet files;
  files.remove(dir / "gone");
  files.write(dir / "a", "new a");
  files.write(dir / "b", "new b");
  files.write(dir / "later/c", "new c");
  std::filesystem::remove_all(dir / "later");
  try {
    files.commit();
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), dir / "later/c");
  }
  EXPECT_EQ(test::read_file(dir / "a"), "old a");
  EXPECT_EQ(test::read_file(dir / "gone"), "still here");
  EXPECT_FALSE(std::filesystem::exists(dir / "b"));
}

TEST(FileSet, LeavesNothingWhenItIsNotCommitted) {
  const TemporaryDirectory dir;
  FileSet().write(dir / "a", "never");
  EXPECT_EQ(dir.entries(), Names{});
}

TEST(StaleTemporaries, OfAKilledProcessAreRemoved) {
  const TemporaryDirectory dir;
  kill_a_writer_of(dir / "trajectory.csv");
  ASSERT_EQ(dir.entries().size(), 1u);
  EXPECT_EQ(remove_stale_temporaries(dir.path()), 1u);
  EXPECT_EQ(dir.entries(), Names{});
}

TEST(StaleTemporaries, ThatAreBeingWrittenStay) {
  const TemporaryDirectory dir;
  AtomicFile file(dir / "a.csv");
  file.append("still here");
  EXPECT_EQ(remove_stale_temporaries(dir.path()), 0u);
  file.commit();
  EXPECT_EQ(test::read_file(dir / "a.csv"), "still here");
}

TEST(StaleTemporaries, OfAKilledProcessDoNotDisturbTheNextWriter) {
  const TemporaryDirectory dir;
  kill_a_writer_of(dir / "a.csv");
  write_file_atomically(dir / "a.csv", "new");
  EXPECT_EQ(test::read_file(dir / "a.csv"), "new");
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
}

TEST(StaleTemporaries, ThatAnotherProcessWritesStay) {
  const TemporaryDirectory dir;
  int ready[2], go[2];
  ASSERT_EQ(::pipe(ready), 0);
  ASSERT_EQ(::pipe(go), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  char byte = 0;
  if (child == 0) {
    AtomicFile file(dir / "a.csv");
    file.append("still here");
    (void)!::write(ready[1], "r", 1);
    (void)!::read(go[0], &byte, 1);
    file.commit();
    ::_exit(0);
  }
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_EQ(remove_stale_temporaries(dir.path()), 0u);
  ASSERT_EQ(::write(go[1], "g", 1), 1);
  int status = 1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(test::read_file(dir / "a.csv"), "still here");
}

TEST(StaleTemporaries, DoNotIncludeFilesOfOtherNamesOrKinds) {
  const TemporaryDirectory dir;
  const Names others = {"..1.tmp", ".1.tmp", ".a.12", ".a.12x.tmp", ".a.tmp", ".tmp", "a.12.tmp", "a.csv"};
  for (const std::string& name : others) write_plainly(dir / name, "");
  std::filesystem::create_directory(dir / ".dir.12.tmp");
  const Names before = dir.entries();
  EXPECT_EQ(remove_stale_temporaries(dir.path()), 0u);
  EXPECT_EQ(dir.entries(), before);
}

TEST(StaleTemporaries, OfAMissingDirectoryAreNone) {
  const TemporaryDirectory dir;
  EXPECT_EQ(remove_stale_temporaries(dir / "missing"), 0u);
}

TEST(StaleTemporaries, OfAFileThatIsNoDirectoryThrowNamingIt) {
  const TemporaryDirectory dir;
  write_plainly(dir / "file", "");
  try {
    remove_stale_temporaries(dir / "file");
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(error.path(), dir / "file");
  }
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
