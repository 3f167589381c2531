#include "results/io/table_writer.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "results/allocations/allocations.hpp"
#include "results/record/recorder.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::table_writer_test {
namespace {

using test::lines_of;
using test::read_file;
using test::TemporaryDirectory;

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

// Random bit patterns reach every exponent, subnormal numbers included.
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

TEST(CsvWriter, WritesCellsWhoseTypesAreKnownLate) {
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
}  // namespace hapbench::table_writer_test
