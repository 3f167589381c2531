#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "results/io/table_writer.hpp"
#include "results/record/recorder.hpp"
#include "results/summary/allocations.hpp"
#include "tests/results/files.hpp"
#include "tests/results/observing.hpp"

namespace hapbench::files_test {
namespace {

using nlohmann::ordered_json;
using test::FileSizeLimit;
using test::lines_of;
using test::read_file;
using test::TemporaryDirectory;
using test::write_plainly;

namespace fs = std::filesystem;
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
  for (const std::size_t bytes : {1'000'000u, 20u}) {  // many times the buffer size, and less than the buffer size
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

/// Starts a process that writes `target`, and kills the process before the file is complete. The unfinished file that
/// the process leaves is longer than all files that the tests write.
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

TEST(JsonText, KeepsTheOrderOfKeysAndWritesPlainArraysOnOneLine) {
  const ordered_json value = {{"z", 1},
                              {"a", {0.1, 2, "x", nullptr, true}},
                              {"nested", {{"points", {{0, 1}, {2, 3}}}}},
                              {"none", ordered_json::object()},
                              {"empty", ordered_json::array()}};
  EXPECT_EQ(json_text(value), R"({
  "z": 1,
  "a": [0.1, 2, "x", null, true],
  "nested": {
    "points": [
      [0, 1],
      [2, 3]
    ]
  },
  "none": {},
  "empty": []
}
)");
}

TEST(JsonText, WritesNumbersThatAreNotFiniteAsNull) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(json_text({inf, -inf, std::nan("")}), "[null, null, null]\n");
}

TEST(JsonText, EscapesStringsAndKeysAndReplacesBytesThatAreNotUtf8) {
  ordered_json value;
  value["a\"b"] = "line\nend \xff";
  EXPECT_EQ(json_text(value), "{\n  \"a\\\"b\": \"line\\nend \xef\xbf\xbd\"\n}\n");
}

// Checks the shortest form of doubles. nlohmann's writer prints 5e-324 as 4.94…e-324, and adds ".0" to whole numbers.
TEST(JsonText, WritesDoublesInShortestForm) {
  EXPECT_EQ(json_text({0.1, 1.0, 5e-324, 1e22, -0.0}), "[0.1, 1, 5e-324, 1e+22, -0]\n");
}

TEST(CsvWriter, WritesHeaderAndRowsWithEmptyCells) {
  const TemporaryDirectory dir;
  CsvWriter csv(dir / "a.csv", "n,x,y,z,maybe,name");
  csv.row(std::uint64_t{18446744073709551615u}, Vec3(1.0, -0.5, 0.0), std::optional<double>(), "plain");
  csv.row(std::uint64_t{0}, Vec3(0.1, 1e-5, 1e300), std::optional(0.25), "");
  constexpr double inf = std::numeric_limits<double>::infinity();
  csv.row(std::uint64_t{1}, Vec3(inf, -inf, std::numeric_limits<double>::quiet_NaN()), std::optional(-0.0), "");
  csv.finish();
  EXPECT_EQ(read_file(dir / "a.csv"),
            "n,x,y,z,maybe,name\n"
            "18446744073709551615,1,-0.5,0,,plain\n"
            "0,0.1,1e-05,1e+300,0.25,\n"
            "1,inf,-inf,nan,-0,\n");
}

TEST(CsvWriter, QuotesTextThatWouldBreakTheTable) {
  const TemporaryDirectory dir;
  CsvWriter csv(dir / "a.csv", "text");
  csv.row("a,b");
  csv.row("say \"x\"");
  csv.row("two\nlines");
  csv.finish();
  EXPECT_EQ(read_file(dir / "a.csv"), "text\n\"a,b\"\n\"say \"\"x\"\"\"\n\"two\nlines\"\n");
}

// Checks random bit patterns, which include all exponents and subnormal numbers.
TEST(CsvWriter, NumbersReadBackBitForBit) {
  const TemporaryDirectory dir;
  std::mt19937_64 bits(1);
  std::vector<double> numbers = {0.0, -0.0, 0.1, std::numeric_limits<double>::denorm_min(),
                                 std::numeric_limits<double>::max()};
  while (numbers.size() < 5000) {
    const auto number = std::bit_cast<double>(bits());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  CsvWriter csv(dir / "a.csv", "number");
  for (const double number : numbers) csv.row(number);
  csv.finish();

  const auto lines = lines_of(read_file(dir / "a.csv"));
  ASSERT_EQ(lines.size(), numbers.size() + 1);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double read = test::number_in(lines[i + 1]);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(read), std::bit_cast<std::uint64_t>(numbers[i])) << lines[i + 1];
  }
}

TEST(CsvWriter, WritesCellsWhoseTypesAreKnownOnlyAtTheEnd) {
  const TemporaryDirectory dir;
  CsvWriter csv(dir / "fruits.csv", "name,weight_kg,seeds,ripe");
  csv.cells(std::vector<Cell>{"apple, red", 0.25, std::uint64_t{5}, true});
  csv.cells(std::vector<Cell>{"plum", Cell(), std::uint64_t{1}, false});
  csv.finish();
  EXPECT_EQ(read_file(dir / "fruits.csv"), "name,weight_kg,seeds,ripe\n\"apple, red\",0.25,5,true\nplum,,1,false\n");
}

TEST(MemoryTable, KeepsEveryRowOfARecorderWithoutTheHeapWhileItGrows) {
  const ContactBuffer contacts = test::contacts_along(std::vector<Vec3>(100, Vec3::UnitX()));
  MemoryTable table(kContactTable.columns);
  Recorder recorder(&table, contact_rows());
  const AllocationCount count;
  for (std::uint64_t k = 0; k < 1000; ++k) recorder.on_step(test::row(k, 0.0, contacts));
  EXPECT_EQ(count.value(), 0u);
  recorder.finish();
  ASSERT_EQ(table.rows(), 100'000u);
  const std::size_t columns = kContactTable.columns.size();
  for (std::size_t i = 0; i < table.rows(); ++i)
    ASSERT_EQ(table.numbers()[columns * i], static_cast<double>(i / 100)) << "its step";
  EXPECT_EQ(table.numbers().back(), 1.0);
}

}  // namespace
}  // namespace hapbench::files_test
