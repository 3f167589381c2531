#include "results/io/atomic_file.hpp"

#include <gtest/gtest.h>

#include <atomic>
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

TEST(AtomicFile, OverADirectoryThrowsAtCommitAndLeavesNoTemporary) {
  const TemporaryDirectory dir;
  std::filesystem::create_directory(dir / "a.csv");
  AtomicFile file(dir / "a.csv");
  EXPECT_THROW(file.commit(), IoError);
  EXPECT_EQ(dir.entries(), Names{"a.csv"});
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

}  // namespace
}  // namespace hapbench::atomic_file_test
