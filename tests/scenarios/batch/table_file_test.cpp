#include "scenarios/batch/table_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "results/io/atomic_file.hpp"
#include "scenarios/batch/join_shards.hpp"
#include "scenarios/batch/shard.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mutation.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// Tests tables that grow, are interrupted and are joined.
namespace hapbench::table_file_test {
namespace {

namespace fs = std::filesystem;
using test::read_file;

using Rows = std::vector<std::string>;

class TableFiles : public testing::Test {
 protected:
  TableTitle title(const std::string& definition = "mine") const {
    return {file_, "index,a", {{"definition", definition}}, 9};
  }
  /// Returns the rows that a table keeps when it is opened again to be continued.
  Rows resumed(const std::string& definition = "mine") const {
    Rows rows;
    const TableFile table(title(definition), [&](std::size_t, std::string_view row) {
      rows.emplace_back(row);
      return true;
    });
    return rows;
  }
  /// Writes a partial table, as a killed process leaves it, and returns the bytes of its file.
  std::string left(const Rows& rows) const {
    TableFile table(title());
    for (const std::string& row : rows) table.add(static_cast<std::size_t>(row[0] - '0'), row);
    return read_file(part_);
  }
  static void expect_refusal(const std::function<void()>& work, const std::string& says) {
    const auto error = test::input_error_of(work);
    ASSERT_TRUE(error) << says;
    EXPECT_NE(std::string(error->what()).find(says), std::string::npos) << error->what();
  }
  test::TemporaryDirectory directory_;
  const fs::path file_ = directory_ / "sweep.csv", part_ = directory_ / "sweep.csv.part";
};

TEST_F(TableFiles, HaveTheirRowsInOrderAndOfTwoTheLater) {
  TableFile table(title());
  for (const char* row : {"7,x", "0,b", "3,old", "3,new"}) table.add(static_cast<std::size_t>(row[0] - '0'), row);
  EXPECT_FALSE(fs::exists(file_));
  table.finish();
  EXPECT_EQ(read_file(file_), "index,a\n0,b\n3,new\n7,x\n");
  EXPECT_EQ(directory_.entries(), (Rows{"sweep.csv", "sweep.json"}));
  EXPECT_EQ(resumed(), (Rows{"0,b", "3,new", "7,x"})) << "of a finished one";
}

TEST_F(TableFiles, CutShortAnywhereKeepTheWholeLinesAndGoOn) {
  const Rows rows = {"0,a", "1,bcd", "2," + std::string(10'000, 'e')};
  const std::string whole = left(rows);
  for (std::size_t size = 0; size <= whole.size(); size += size < 30 ? 1 : 997) {
    test::write_plainly(part_, whole.substr(0, size));
    const auto lines = std::count(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size), '\n');
    const Rows expected(rows.begin(), rows.begin() + std::max<std::ptrdiff_t>(lines - 1, 0));
    ASSERT_EQ(resumed(), expected) << size;
    ASSERT_EQ(TableFile::rows_in_progress(file_), expected.size());
  }
}

TEST_F(TableFiles, OfAnotherDefinitionAreRefusedAndLeftAlone) {
  const std::string whole = left({"0,a"});
  expect_refusal([&] { resumed("theirs"); }, "sweep.csv.part: is not the table of this sweep");
  expect_refusal([&] { TableFile(title("theirs")); }, "sweep.csv.part: holds 1 finished runs of another sweep");
  EXPECT_EQ(read_file(part_), whole);
  fs::remove(directory_ / "sweep.json.part");
  expect_refusal([&] { resumed(); }, "sweep.json.part is missing; allowed: another --out");
}

TEST_F(TableFiles, DamagedAtRandomAreReadOrRefused) {
  Random random(20261120);
  const std::string whole = left({"0,a", "1,bcd", "2,e"});
  for (int i = 0; i < 300; ++i) {
    test::write_plainly(part_, test::mutated_text(whole, random));
    try {
      for (const std::string& row : resumed()) EXPECT_LT(row[0], '9') << row;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(part_.string()), 0u) << error.what();
    }
  }
}

TEST_F(TableFiles, ThatAnotherProcessBeginsAnewEndWithAnError) {
  TableFile table(title());
  left({"1,a"});
  EXPECT_THROW(table.finish(), IoError);
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(TableFiles, OnAFullDiskAreAnErrorThatNamesThem) {
  TableFile table(title());
  const test::FileSizeLimit limit(200);
  const std::string row = "0," + std::string(60, 'a');
  std::size_t added = 0;
  try {
    for (; added < 10; ++added) table.add(0, row);
    ADD_FAILURE() << "no error";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find(part_.string()), std::string::npos) << error.what();
  }
  EXPECT_EQ(added, 3u);  // a header of 8 bytes and 63 bytes for each row; the fourth row would exceed 200 bytes
}

TEST_F(TableFiles, OfShardsAreJoinedWhenAllAreThere) {
  const auto write_shard = [&](std::size_t i, std::size_t n, const Rows& rows, const std::string& definition = "mine") {
    TableTitle shard = title(definition);
    shard.file = directory_ / table_name(Shard{i, n});
    shard.about["runs"] = 4;
    shard.about["shard"] = shard_text({i, n});
    TableFile table(shard);
    for (const std::string& row : rows) table.add(static_cast<std::size_t>(row[0] - '0'), row);
    table.finish();
  };
  const auto join = [&] { return join_shards(directory_.path()); };
  EXPECT_FALSE(join());
  write_shard(1, 3, {"3,d"});
  expect_refusal([&] { join(); }, "2 of 3 shards missing: 0/3, 2/3");
  write_shard(0, 3, {"0,a", "2,\"b,\""});
  write_shard(2, 3, {"1,c"}, "theirs");
  expect_refusal([&] { join(); }, "sweep.2_of_3.csv: is of another sweep than ");
  write_shard(2, 3, {});
  expect_refusal([&] { join(); }, "the shards have 3 of 4 rows");
  write_shard(2, 3, {"1,c"});
  EXPECT_TRUE(join());
  EXPECT_EQ(read_file(file_), "index,a\n0,a\n1,c\n2,\"b,\"\n3,d\n");
  EXPECT_EQ(Json::parse(read_file(directory_ / "sweep.json"))["shard"], "0/1");
  EXPECT_EQ(directory_.entries().size(), 8u) << "nothing else is left";
  write_shard(1, 3, {"3,new"});
  EXPECT_TRUE(join());
  EXPECT_EQ(read_file(file_), "index,a\n0,a\n1,c\n2,\"b,\"\n3,new\n");
  write_shard(0, 2, {"0,a"});
  expect_refusal([&] { join(); }, "allowed: shards of one sweep");
}

}  // namespace
}  // namespace hapbench::table_file_test
