#include "scenarios/batch/csv_cells.hpp"

#include <gtest/gtest.h>

#include "results/io/columns.hpp"

namespace hapbench::csv_cells_test {
namespace {

using Rows = std::vector<std::string>;

TEST(CsvCells, AreWhatTheyWereWithCommasAndQuotes) {
  for (const Rows& cells : {Rows{""}, Rows{"a", "", "b"}, Rows{R"({"a":[1,2]})", "\"", ",", "\",\"", "x"}}) {
    std::string line;
    for (const std::string& cell : cells) line += (line.empty() && &cell == &cells[0] ? "" : ",") + csv_cell(cell);
    EXPECT_EQ(csv_cells(line), cells) << line;
  }
}

}  // namespace
}  // namespace hapbench::csv_cells_test
