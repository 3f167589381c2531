#include "scenarios/batch/sweep_table.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/mutation.hpp"

/// Tables of shards read back; whole sweeps are merged in program/sweep_command_test.cpp.
namespace hapbench::sweep_table_test {
namespace {

namespace fs = std::filesystem;

/// Lets this process have only so many files open while it lives.
class OpenFileLimit {
 public:
  explicit OpenFileLimit(::rlim_t files) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const ::rlimit limit{files, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }
  ~OpenFileLimit() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  OpenFileLimit(const OpenFileLimit&) = delete;
  OpenFileLimit& operator=(const OpenFileLimit&) = delete;

 private:
  ::rlimit before_{};
};

class ShardTables : public testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& text) const {
    test::write_plainly(directory_ / name, text);
    return directory_ / name;
  }
  static std::vector<std::string> rows_of(const fs::path& path, std::size_t piece = 1 << 16) {
    ShardRows rows(path, piece);
    std::vector<std::string> found;
    while (const auto row = rows.next()) found.emplace_back(*row);
    return found;
  }
  /// The message of the error in a table with this text; empty if there is none.
  std::string complaint(const std::string& text) const {
    const auto error = test::input_error_of([&] { rows_of(file("bad.csv", text)); });
    return error ? error->what() : "";
  }
  test::TemporaryDirectory directory_;
  const std::string good_ =
      "# hapbench sweep, shard 1/2 of 5 runs, definition 0123456789abcdef\n"
      "index,a,outcome\n"
      "1,x,completes\n"
      "3,y,completes\n";
};

TEST_F(ShardTables, AreReadAsTheyWereWritten) {
  const fs::path path = file("good.csv", good_);
  const ShardTitle table = ShardRows(path).title();
  EXPECT_EQ(table.shard.index, 1u);
  EXPECT_EQ(table.shard.count, 2u);
  EXPECT_EQ(table.runs, 5u);
  EXPECT_EQ(table.definition, "0123456789abcdef");
  EXPECT_EQ(table.header, "index,a,outcome");
  for (std::size_t piece = 1; piece < 200; ++piece) {
    EXPECT_EQ(rows_of(path, piece), (std::vector<std::string>{"1,x,completes", "3,y,completes"})) << piece;
  }
}

TEST_F(ShardTables, ThatAreNoneAreRefusedWithTheLine) {
  const auto with = [this](const std::string& from, const std::string& to) {
    std::string text = good_;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::pair<std::string, std::string> bad[] = {
      {"", ", line 1: is not the table of a shard"},
      {"index,a,outcome\n1,x,completes\n", ", line 1: is not the table of a shard"},
      {with("1/2", "2/2"), ", line 1: is not"},
      {with("1/2", "1/2/2"), ", line 1: is not"},
      {with("of 5", "of 99999999999999999999"), ", line 1: is not"},
      {with("of 5", "of 1000000000"), ", line 1: is not"},
      {with("1/2", "1/1000000000"), ", line 1: is not"},
      {with("of 5", "of  5"), ", line 1: is not"},
      {with("cdef\n", "cdef\r\n"), ", line 1: is not"},
      {with("index,", "number,"), ", line 2: is not the header"},
      {good_.substr(0, good_.find('\n') + 1), ", line 2: is not the header"},
      {with("1,x,", "1,"), ", line 3: got 2 cells; allowed: 3"},
      {with("1,x,", "1,x,,"), ", line 3: got 4 cells; allowed: 3"},
      {with("3,y", "1,y"), ", line 4: got run \"1\"; allowed: 3, the next of the shard"},
      {with("3,y", "5,y"), ", line 4: got run \"5\"; allowed: 3"},
      {with("3,y", "-3,y"), ", line 4: got run \"-3\"; allowed: 3"},
      {with("1,x,completes\n", ""), ", line 3: got run \"3\"; allowed: 1"},
      {good_ + "5,z,completes\n", ", line 5: got a row behind the last one"},
      {with("3,y,completes\n", ""), ": ends after 1 of 2 rows"},
      {good_.substr(0, good_.size() - 1), ": ends within a line"},
      {good_.substr(0, good_.size() - 5), ": ends within a line"},
  };
  for (const auto& [text, says] : bad) {
    const std::string problem = complaint(text);
    EXPECT_EQ(problem.find((directory_ / "bad.csv").string() + says), 0u) << problem << "\nfor\n" << text;
  }
}

TEST_F(ShardTables, DamagedAtRandomAreReadOrRefused) {
  Random random(20261120);
  for (int i = 0; i < 500; ++i) {
    const fs::path damaged = file("damaged.csv", test::mutated_text(good_, random));
    try {
      const ShardTitle table = ShardRows(damaged).title();
      EXPECT_EQ(rows_of(damaged).size(), table.shard.size(table.runs));
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(damaged.string()), 0u) << error.what();
    }
  }
}

TEST_F(ShardTables, MoreThanAProcessMayHaveOpenAreMerged) {
  constexpr std::size_t kShards = 1200, kRuns = 3000;
  const OpenFileLimit limit(64);
  std::vector<fs::path> files;
  std::string whole = "index,a\n";
  for (std::size_t i = 0; i < kShards; ++i) {
    std::string text = title_line({i, kShards}, kRuns, "d") + "\nindex,a\n";
    for (std::size_t run = i; run < kRuns; run += kShards) text += std::to_string(run) + ",x\n";
    files.push_back(file(std::to_string(i) + ".csv", text));
  }
  for (std::size_t run = 0; run < kRuns; ++run) whole += std::to_string(run) + ",x\n";
  EXPECT_EQ(merge_shard_tables(directory_ / "all.csv", files), kRuns);
  EXPECT_EQ(test::read_file(directory_ / "all.csv"), whole);
  EXPECT_FALSE(fs::exists(directory_ / "all.json"));
}

TEST_F(ShardTables, DamagedBehindTheTitleLeaveNothingBehind) {
  const std::string other = title_line({0, 2}, 5, "0123456789abcdef") + "\nindex,a,outcome\n0,x,o\n2,x,o\n4,x,o\n";
  const std::vector<fs::path> files = {file("1.csv", good_ + "5,z,completes\n"), file("0.csv", other)};
  const auto error = test::input_error_of([&] { merge_shard_tables(directory_ / "all.csv", files); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("1.csv, line 5: got a row behind the last one"), std::string::npos);
  EXPECT_EQ(directory_.entries(), (std::vector<std::string>{"0.csv", "1.csv"}));
}

TEST_F(ShardTables, MustBeAllThoseOfOneSweep) {
  const auto table = [](std::size_t index, std::size_t count) {
    return ShardTitle{"shard_" + std::to_string(index) + ".csv", {index, count}, 5, "d", "index,a"};
  };
  const auto complaint_about = [](std::vector<ShardTitle> tables) {
    const auto error = test::input_error_of([&] { check_complete(tables); });
    return std::string(error ? error->what() : "");
  };
  check_complete(std::vector{table(2, 3), table(0, 3), table(1, 3)});
  EXPECT_EQ(complaint_about({table(2, 3), table(0, 3)}), "1 of 3 shards missing: 1/3");
  EXPECT_EQ(complaint_about({table(1, 100'000)}),
            "99999 of 100000 shards missing: 0/100000, 2/100000, 3/100000, 4/100000, 5/100000, 6/100000, 7/100000, "
            "8/100000, 9/100000, 10/100000, ...");
  EXPECT_EQ(complaint_about({table(0, 2), table(1, 2), table(0, 2)}),
            "shard_0.csv: is shard 0/2, as is shard_0.csv; allowed: each shard once");
  const auto other = [&](auto change) {
    ShardTitle changed = table(1, 2);
    change(changed);
    return complaint_about({table(0, 2), changed});
  };
  const std::string start = "shard_1.csv: is of another sweep than shard_0.csv: ";
  EXPECT_EQ(other([](ShardTitle& t) { t.definition = "e"; }).find(start + "definition e, there d;"), 0u);
  EXPECT_EQ(other([](ShardTitle& t) { t.runs = 6; }).find(start + "runs 6, there 5;"), 0u);
  EXPECT_EQ(other([](ShardTitle& t) { t.shard.count = 3; }).find(start + "shards 3, there 2;"), 0u);
  EXPECT_EQ(other([](ShardTitle& t) { t.header = "index,b"; }).find(start + "columns index,b, there index,a;"), 0u);
}

}  // namespace
}  // namespace hapbench::sweep_table_test
