#include "results/io/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <string>

#include "tests/results/files.hpp"

namespace hapbench::stale_temporaries_test {
namespace {

using test::TemporaryDirectory;
using test::write_plainly;
using Names = std::vector<std::string>;

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
  EXPECT_EQ(remove_stale_temporaries(dir.path()), 1u);
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

}  // namespace
}  // namespace hapbench::stale_temporaries_test
